#include "lab/scale/rain.h"

#include <cmath>

#include <fmt/format.h>

namespace aurasim::lab {
namespace {

/// The two injectors of scenes/columns_rain.yaml.
constexpr int kNearBoundaries = 0;
constexpr int kInTheMiddle = 1;

}  // namespace

core::Step Rain::steps(double step_s) const { return std::llround(run_s / step_s); }

std::string Rain::name() const {
  return fmt::format("{}-{}-in-{}-{}-U{:g}-K{}-{:g}per_s-{:g}of{:g}s-border{:g}-{:g}m_s-{:g}B_s-{}", series,
                     regions.name(), world.name(), aura, uncertainty, lookahead, rate_per_s, rain_s, run_s,
                     border_share, fall_m_s, bandwidth_B_s, repeat);
}

std::vector<std::string> Rain::overrides() const {
  std::vector<std::string> all = {
      "regions=" + regions.yaml(),
      "scene.layout=" + world.yaml(),
      "exchange=aura",
      "aura.radius=" + aura,
      fmt::format("aura.uncertainty={}", uncertainty),
      "physics.solver=soft_step",
      "time.substeps=4",
      "time.lookahead=" + (lookahead > 0 ? fmt::to_string(lookahead) : std::string("auto")),
  };
  // One region has no boundaries: everything falls into its middle. The same holds if no body is to fall near
  // boundaries.
  const bool middle_only = world.count == 1 || border_share <= 0;
  const double share = middle_only || border_share >= 1 ? 0.5 : border_share;
  const auto set = [&](int injector, const char* key, const std::string& value) {
    all.push_back(fmt::format("scene.injectors[{}].{}={}", injector, key, value));
  };
  if (middle_only) set(kNearBoundaries, "per", "{regions: {size: [20, 20, 20], height: 15}}");
  if (border_share >= 1) set(kInTheMiddle, "per", "{boundaries: {distance: 12, size: [20, 150, 20], height: 15}}");
  const auto near = static_cast<std::uint64_t>(std::llround(share * static_cast<double>(bodies())));
  for (const int injector : {kNearBoundaries, kInTheMiddle}) {
    const bool first = injector == kNearBoundaries;
    set(injector, "rate", fmt::to_string(rate_per_s * (first ? share : 1 - share)));
    set(injector, "count", fmt::to_string(first ? near : bodies() - near));
    set(injector, "seed", fmt::to_string(1 + injector + 10 * repeat));
    set(injector, "velocity", fmt::format("{{min: [-{0}, -{0}, -{0}], max: [{0}, {0}, 0]}}", fall_m_s));
  }
  return all;
}

}  // namespace aurasim::lab
