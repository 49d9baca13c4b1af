#include "lab/stability/stability.h"

#include <algorithm>

#include "config/presets.h"
#include "physics/solver_names.h"

namespace aurasim::lab {
namespace {

/// Cases that have to stand for a minute.
constexpr const char* kStanding[] = {"stack_20", "card_house", "pyramid", "mass_ratio_100"};

struct Planned {
  Case what;
  RunRules rules;
  std::string preset;
  bool is_standing = false;
};

bool wanted(const StabilityPlan& plan, const std::string& name) {
  return plan.cases.empty() || std::find(plan.cases.begin(), plan.cases.end(), name) != plan.cases.end();
}

std::vector<Planned> planned_runs(const StabilityPlan& plan) {
  std::vector<Planned> runs;
  for (Case& c : stability_cases()) {
    if (!wanted(plan, c.name)) continue;
    for (const int hz : plan.step_hz) {
      RunRules rules;
      rules.step_hz = hz;
      runs.push_back({c, rules, ""});
    }
    for (const config::Preset& preset : config::kPresets) runs.push_back({c, preset_rules(preset.name), preset.name});
  }
  if (plan.standing_s <= 0) return runs;
  for (const char* name : kStanding) {
    if (!wanted(plan, name)) continue;
    Case c = stability_case(name);
    c.duration_s = plan.standing_s;
    runs.push_back({c, preset_rules("balanced"), "balanced", true});
    c.name += "_may_sleep";
    for (core::Prototype& prototype : c.scene.prototypes) prototype.can_sleep = true;
    runs.push_back({c, preset_rules("balanced"), "balanced", true});
  }
  return runs;
}

}  // namespace

core::Step StabilityRow::first_difference() const {
  const auto [a, b] = std::mismatch(one.hash.begin(), one.hash.end(), two.hash.begin(), two.hash.end());
  return a == one.hash.end() && b == two.hash.end() ? -1 : a - one.hash.begin();
}

RunRules preset_rules(const std::string& name) {
  const config::Preset& preset = config::preset_named(name);
  RunRules rules;
  rules.substeps = preset.substeps;
  rules.iterations = preset.iterations;
  rules.friction_directions = preset.friction_directions;
  rules.solver = physics::solver_named(preset.solver);
  return rules;
}

StabilityRow run_stability(const Case& c, const RunRules& rules) {
  return {c, rules, run_case(c, rules, one_node()), run_case(c, rules, columns_at(c.border_x_m, 2)), "", false};
}

std::vector<StabilityRow> run_stability(const StabilityPlan& plan, const Progress& progress) {
  const std::vector<Planned> runs = planned_runs(plan);
  const auto cost = [](const Planned& run) {
    return run.what.duration_s * run.rules.step_hz * run.rules.substeps *
           static_cast<double>(run.what.scene.bodies.size());
  };
  double whole = 0, done = 0;
  for (const Planned& run : runs) whole += cost(run);
  std::vector<StabilityRow> rows;
  for (const Planned& run : runs) {
    if (!progress(done / whole)) break;
    StabilityRow& row = rows.emplace_back(run_stability(run.what, run.rules));
    row.preset = run.preset;
    row.is_standing = run.is_standing;
    done += cost(run);
  }
  return rows;
}

}  // namespace aurasim::lab
