// The requirements of the stability experiment.
#include <algorithm>

#include <fmt/format.h>

#include "lab/stability/stability.h"

namespace aurasim::lab {
namespace {

/// One metric of one case at most `allowed`, at a step rate with Bullet's settings, or with a preset.
struct Requirement {
  const char* name;
  std::size_t metric;
  double allowed;
  int step_hz = 0;  ///< 0: with the preset
  const char* preset = "";
  bool standing = false;  ///< in the long run
};

void require(std::vector<Target>& targets, const std::vector<StabilityRow>& rows, const Requirement& wanted) {
  for (const StabilityRow& row : rows) {
    if (row.what.name != wanted.name || row.preset != wanted.preset || row.is_standing != wanted.standing) continue;
    if (wanted.step_hz != 0 && row.rules.step_hz != wanted.step_hz) continue;
    const Metric& m = row.what.metrics[wanted.metric];
    const std::string when = row.preset.empty() ? fmt::format("1/{} s", row.rules.step_hz)
                                                : fmt::format("preset {}, {:g} s", row.preset, row.what.duration_s);
    targets.push_back({fmt::format("{}, {}: {} ({})", wanted.name, when, m.measured, m.unit),
                       row.one.errors[wanted.metric], wanted.allowed});
  }
}

}  // namespace

std::vector<Target> stability_targets(const std::vector<StabilityRow>& rows) {
  const auto other_bits = std::count_if(rows.begin(), rows.end(), [](const auto& row) { return !row.same_bits(); });
  std::vector<Target> targets = {
      {"runs whose bits on two nodes differ from those on one", static_cast<double>(other_bits), 0}};
  require(targets, rows, {"dzhanibekov", 0, 1e-3, 60});
  require(targets, rows, {"dzhanibekov", 1, 1e-2, 60});
  require(targets, rows, {"bouncing_ball_1", 0, 0.01, 240});
  require(targets, rows, {"rolling_plate_no_erp", 0, 1e-27, 0, "exact"});
  require(targets, rows, {"bullet_ccd_on", 0, 0, 60});
  for (const char* name : {"free_fall", "projectile"}) {
    for (const char* preset : {"fast", "balanced"}) {
      require(targets, rows, {name, 0, 1e-9, 0, preset});
    }
  }
  for (const char* name : {"stack_20", "card_house", "pyramid", "mass_ratio_100", "stack_20_may_sleep",
                           "card_house_may_sleep", "pyramid_may_sleep", "mass_ratio_100_may_sleep"}) {
    require(targets, rows, {name, 1, 0, 0, "balanced", true});
  }
  return targets;
}

}  // namespace aurasim::lab
