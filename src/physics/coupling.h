// What a world needs to be coupled with the worlds of other regions (docs/design.md, "Coupled regions"): bodies near
// borders are known to both sides, and contacts between bodies of several regions are solved by each of them.
#pragma once

#include <span>

#include "core/block_owners.h"
#include "core/scene.h"
#include "core/seam_mail.h"
#include "core/seam_partners.h"
#include "physics/settings.h"

namespace aurasim::physics {

/// The pointers have to outlive the world.
struct Coupling {
  core::RegionId self{};
  const core::BlockOwners* owners = nullptr;
  core::SeamMail* mail = nullptr;
  /// Null: all regions exchange parcels in each step.
  const core::SeamPartners* partners = nullptr;

  /// Do this region and another one exchange parcels in this step?
  bool meets(core::RegionId other) const {
    return other != self && (partners == nullptr || partners->are_partners(self, other));
  }
  /// See core::SeamPartners. Precondition: this region meets the other one.
  bool may_share_chains(core::RegionId other) const {
    return partners == nullptr || partners->may_share_chains(self, other);
  }
};

/// Calls work(region) for each other region that exchanges parcels with this one in this step.
template <class Work>
void for_each_peer(const Coupling& coupling, Work&& work) {
  for (std::uint32_t i = 0; i < coupling.owners->size(); ++i) {
    if (coupling.meets(core::RegionId{i})) work(core::RegionId{i});
  }
}

/// Throws std::logic_error unless the two regions exchange parcels in this step. For what has to be sent.
void expect_to_meet(const Coupling& coupling, core::RegionId other);
/// The same for these regions, each with each and with this one.
void expect_all_to_meet(const Coupling& coupling, std::span<const core::RegionId> others);

/// The owners of the blocks of a scene whose regions are coupled, with the territories that follow from its bodies.
core::BlockOwners block_owners(const core::RegionMap& map, const core::Scene& scene, const Settings& settings);

/// Added to the bounds of bodies, m. Covers the damping of speeds in the step, and rounding.
inline constexpr double kReachSlack_m = 0.05;

/// How far a body of this speed gets in a step at most, m. Orders and setpoints may make it as fast as
/// Settings::top_speed_m_s before the step.
double way_ahead_m(double gravity_m_s2, const Settings& settings, double speed_m_s);

}  // namespace aurasim::physics
