// Coupled regions (core/seam_partners.h): which regions have to exchange parcels in the next step though they are not
// near each other.
//
// Two kinds of bodies make it necessary. Bodies that may reach beyond the surroundings of their region may touch what
// regions far away host. And contacts in the phase of giants may form chains over many regions, whose hosts all have to
// know the whole chain. The host of such a body names all regions whose surroundings the body may reach. So the hosts
// of two bodies that touch, one of which is such a body, are connected by these pairs: directly, or by way of the owner
// of the place where they touch. The hosts of a chain are then one group.
#include <algorithm>

#include "core/keep_one_of_each.h"
#include "physics/bounds.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/simulation.h"
#include "physics/soft/seams.h"

namespace aurasim::physics {

/// May a body have a contact of the phase of giants in the next step? Two bodies that are no giants have one only if
/// what they reach is large for a block: docs/design.md, "Blocks", with the reach of each instead of radius and gap.
bool Simulation::may_be_in_chains(const HostedBody& body, double way_m) const {
  const BodyPlace& place = place_of(*body.rigid);
  const core::Vec3 p_WB = from_bullet(body.rigid->getWorldTransform().getOrigin());
  if (soft_place(p_WB, place.block, place.radius_m, settings_.block_m).is_giant) return true;
  const double outside_m = core::outside_m(p_WB, place.block, settings_.block_m);
  return outside_m + 2 * (place.radius_m + way_m) >= settings_.block_m / 4;
}

/// Appends the regions whose surroundings the body may reach in the next step, and the one that is to host it.
void Simulation::find_reached(const HostedBody& body, double way_m, std::vector<core::RegionId>& reached) const {
  const core::BlockOwners& owners = *coupling_->owners;
  const Bounds reach = bounds_of(*body.rigid).grown(scalar(2 * way_m));
  const core::RegionId host = host_of(body);
  for (std::uint32_t i = 0; i < owners.size(); ++i) {
    const core::RegionId region{i};
    if (region == host || overlap(reach, owners.surroundings(region))) reached.push_back(region);
  }
}

/// Does a region have to look at the body in each step? A sleeper of its own inside it cannot reach anybody else's
/// surroundings before it is noted as changed.
bool Simulation::is_to_be_watched(const HostedBody& body) const {
  if (!body.born) return false;  // it is noted when it is born
  if (body.rigid->isActive() || is_guest(*body.rigid) || host_of(body) != coupling_->self) return true;
  const double speed_m_s = static_cast<double>(body.rigid->getLinearVelocity().length());
  const double way_m = 2 * way_ahead_m(scene_->gravity.norm(), settings_, speed_m_s);
  const btVector3& p_WB = body.rigid->getWorldTransform().getOrigin();
  Bounds reach = Bounds{p_WB, p_WB}.grown(scalar(place_of(*body.rigid).radius_m));
  reach.add(bounds_of(*body.rigid));
  return !is_within(reach.grown(scalar(way_m)), coupling_->owners->interior(coupling_->self));
}

std::vector<core::Introduction> Simulation::introductions_ahead() {
  std::vector<core::Introduction> pairs;
  if (coupling_ == nullptr) return pairs;
  const core::RegionId self = coupling_->self;
  const core::BlockOwners& owners = *coupling_->owners;
  const auto introduce = [&](core::RegionId other) {
    if (other != self) pairs.push_back({std::min(self, other), std::max(self, other)});
  };
  if (!broken_.empty()) {  // whoever had one of them as a guest has to know
    for (std::uint32_t i = 0; i < owners.size(); ++i) introduce(core::RegionId{i});
  }
  const double gravity_m_s2 = scene_->gravity.norm();
  std::vector<core::RegionId> reached;
  watched_.add(notes_.for_borders, table_);
  watched_.for_each(table_, [&](const HostedBody& body) {
    if (!body.born || is_guest(*body.rigid)) return;
    const btVector3& p_WB = body.rigid->getWorldTransform().getOrigin();
    const double way_m =
        way_ahead_m(gravity_m_s2, settings_, static_cast<double>(body.rigid->getLinearVelocity().length()));
    const Bounds around = Bounds{p_WB, p_WB}.grown(scalar(place_of(*body.rigid).radius_m + 2 * way_m));
    const core::RegionId host = host_of(body);
    if (host == self && is_within(around, owners.interior(self))) return;
    const bool is_usual = is_within(around, owners.surroundings(host)) && !may_be_in_chains(body, way_m);
    if (host == self && is_usual) return;
    reached.clear();
    find_reached(body, way_m, reached);
    const auto is_near = [&](core::RegionId region) { return owners.are_near(self, region); };
    if (is_usual && std::ranges::all_of(reached, is_near)) return;
    std::ranges::for_each(reached, introduce);
  });
  core::keep_one_of_each(pairs);
  return pairs;
}

}  // namespace aurasim::physics
