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
    notes_.for_snapshot.note_all();  // its joints are others
    notes_.for_step.note_all();      // bodies that were bound have blocks of their own
  }
  bool any_left = false;
  notes_.for_step.for_each(table_, [&](const HostedBody& body, std::size_t) {
    if (!body.born || !body.rigid->isActive()) return;  // only awake bodies have moved
    BodyPlace& place = place_of(*body.rigid);
    if (place.is_bound || place.is_guest) return;
    const core::Vec3 p_WB = from_bullet(body.rigid->getWorldTransform().getOrigin());
    if (!core::leaves(p_WB, place.block, settings_.block_m)) return;
    place.block = core::block_at(p_WB, settings_.block_m);
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
