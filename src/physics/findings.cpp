#include "physics/findings.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/block.h"
#include "physics/breakdown.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"

namespace aurasim::physics {

std::uint8_t Findings::find(const HostedBody& body, double block_m) {
  if (!body.born) return 0;
  const btRigidBody& rigid = *body.rigid;
  const BodyPlace& place = place_of(rigid);
  if (place.is_guest) return 0;
  std::uint8_t found = has_broken_down(rigid) ? kBroken : 0;
  if (rigid.isActive() && !place.is_bound &&  // only awake bodies have moved
      core::leaves(from_bullet(rigid.getWorldTransform().getOrigin()), place.block, block_m)) {
    found |= kLeftBlock;
  }
  return found;
}

void Findings::look(BodyTable& table, ChangedBodies& changed, double block_m, soft::Team& team) {
  places_.clear();
  changed.for_each(
      table, [this](const HostedBody&, std::size_t place) { places_.push_back(static_cast<std::uint32_t>(place)); });
  found_.resize(places_.size());
  team.side_by_side([&](const soft::Worker& worker) {
    const auto [first, last] = worker.share(places_.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance < last) {
        const btRigidBody& soon = *table[places_[i + kPrefetchDistance]].rigid;
        prefetch_motion(soon), prefetch_flags(soon);
      }
      found_[i] = find(table[places_[i]], block_m);
    }
  });
  are_fresh_ = true;
}

}  // namespace aurasim::physics
