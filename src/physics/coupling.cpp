#include "physics/coupling.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace aurasim::physics {

void expect_to_meet(const Coupling& coupling, core::RegionId other) {
  if (coupling.meets(other)) return;
  throw std::logic_error("region " + std::to_string(core::value_of(coupling.self)) + " has something for region " +
                         std::to_string(core::value_of(other)) + ", and has not said so in the state before");
}

void expect_all_to_meet(const Coupling& coupling, std::span<const core::RegionId> others) {
  Coupling as_seen = coupling;
  for (std::size_t i = 0; i < others.size(); ++i) {
    expect_to_meet(coupling, others[i]);
    as_seen.self = others[i];
    for (const core::RegionId other : others.subspan(i + 1)) expect_to_meet(as_seen, other);
  }
}

core::BlockOwners block_owners(const core::RegionMap& map, const core::Scene& scene, const Settings& settings) {
  std::vector<double> radii_m;
  for (const core::Prototype& kind : scene.prototypes) {
    radii_m.push_back(core::bounding_radius(scene.shapes[kind.shape].shape));
  }
  return {map, settings.block_m, core::usual_reach_m(radii_m, settings.block_m),
          2 * way_ahead_m(scene.gravity.norm(), settings, settings.top_speed_m_s)};
}

double way_ahead_m(double gravity_m_s2, const Settings& settings, double speed_m_s) {
  const double top_m_s = std::max(speed_m_s, settings.top_speed_m_s);
  return kReachSlack_m + settings.step_s * (top_m_s + settings.step_s / 2 * gravity_m_s2);
}

}  // namespace aurasim::physics
