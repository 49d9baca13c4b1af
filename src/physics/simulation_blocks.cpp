// The blocks of bodies (core/block.h), which are part of their state.
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/simulation.h"

namespace aurasim::physics {

/// Gives each body of the present state its block: bodies that are beyond the margin that of their centre, and those
/// of a mechanism that of its first body. Does nothing if that has been done in this state before.
void Simulation::settle_blocks() {
  const bool mechanisms_changed = joints_.mechanisms_changed();
  if (mechanisms_changed) {
    bind_mechanisms();
    findings_.forget();
    notes_.for_snapshot.note_all();  // its joints are others
    notes_.for_step.note_all();      // bodies that were bound have blocks of their own
  }
  bool any_left = false;
  findings_.for_each(Findings::kLeftBlock, table_, notes_.for_step, settings_.block_m, [&](const HostedBody& body) {
    place_of(*body.rigid).block =
        core::block_at(from_bullet(body.rigid->getWorldTransform().getOrigin()), settings_.block_m);
    notes_.note_block(body.id);
    any_left = true;
  });
  if (!any_left && !mechanisms_changed) return;
  for (const core::BoundBody& bound : joints_.mechanisms()) {
    btRigidBody& rigid = *table_.find(bound.body)->rigid;
    const core::Block& of_first = place_of(*table_.find(bound.first)->rigid).block;
    if (place_of(rigid).block == of_first) continue;
    place_of(rigid).block = of_first;
    note_change(rigid);
    notes_.note_block(bound.body);
  }
  records_are_fresh_ = false;
}

void Simulation::bind_mechanisms() {
  for (const HostedBody& body : table_.bodies()) place_of(*body.rigid).is_bound = false;
  for (const core::BoundBody& bound : joints_.mechanisms()) {
    place_of(*table_.find(bound.body)->rigid).is_bound = bound.body != bound.first;
  }
}

}  // namespace aurasim::physics
