// The experiments stability and pareto as rows of results.
#include <fmt/format.h>

#include "lab/pareto.h"
#include "lab/stability/stability.h"
#include "lab/suites/suites.h"
#include "physics/solver_names.h"

namespace aurasim::lab {
namespace {

/// Share of the time that the stability experiment takes of both.
constexpr double kStabilityShare = 0.7;

/// The part of the suite beside the cases of the stability experiment.
constexpr const char* kPareto = "pareto";

/// Cases with few bodies.
const std::vector<std::string> kQuickCases = {"free_fall",       "spring",  "dzhanibekov", "sliding_box",
                                              "bouncing_ball_1", "wedge",   "stack_5",     "mass_ratio_100",
                                              "newtons_cradle",  "chain_50"};

std::string setting_of(const StabilityRow& row) {
  if (row.is_standing) return fmt::format("{}, {:g} s", row.preset, row.what.duration_s);
  return row.preset.empty() ? fmt::format("1_{} s", row.rules.step_hz) : row.preset;
}

void add_stability_rows(const std::vector<StabilityRow>& rows, std::vector<ResultRow>& out) {
  for (const StabilityRow& row : rows) {
    const std::string what = row.what.name + "/" + setting_of(row);
    for (std::size_t i = 0; i < row.what.metrics.size(); ++i) {
      const Metric& metric = row.what.metrics[i];
      out.push_back({what, metric.measured, row.one.errors[i], metric.unit});
    }
    out.push_back({what, "hand-offs on two nodes", static_cast<double>(row.two.hand_offs), "1"});
    out.push_back({what, "CPU time of a step", row.one.cpu_us_per_step, "us"});
  }
}

/// For points that vary the physics: the front and the presets, or the others. For points of nodes: their settings.
std::string name_of(const ParetoPoint& point) {
  const RunRules usual;
  const bool is_about_nodes = point.nodes != 1 || point.rules.sync != usual.sync ||
                              point.rules.lookahead != usual.lookahead || point.rules.aura != usual.aura;
  if (is_about_nodes) {
    return fmt::format("nodes/{}, {}, K = {}, {}", point.nodes, core::name_of(point.rules.sync), point.rules.lookahead,
                       point.rules.aura == core::AuraKind::kTight ? "tight" : "swept");
  }
  const bool is_soft = point.rules.solver == physics::Solver::kSoftStep;
  const std::string_view solver = physics::name_of(point.rules.solver);
  std::string name = is_soft
                         ? fmt::format("{}, {} substeps", solver, point.rules.substeps)
                         : fmt::format("{}, {} iterations x {} substeps, friction in {}", solver,
                                       point.rules.iterations, point.rules.substeps, point.rules.friction_directions);
  if (!point.preset.empty()) name += " (" + point.preset + ")";
  return (point.on_front || !point.preset.empty() ? "front/" : "others/") + name;
}

void add_pareto_rows(const std::vector<ParetoPoint>& points, std::vector<ResultRow>& out) {
  for (const ParetoPoint& point : points) {
    const std::string what = name_of(point);
    out.push_back({what, "CPU time of a step", point.cpu_us_per_step, "us"});
    out.push_back({what, "error", point.error, "1"});
    for (std::size_t i = 0; i < point.errors.size(); ++i) {
      if (what.starts_with("front/")) out.push_back({what, pareto_errors()[i].name, point.errors[i], "1"});
    }
  }
}

}  // namespace

std::vector<std::string> accuracy_parts() {
  std::vector<std::string> parts;
  for (const Case& c : stability_cases()) parts.push_back(c.name);
  parts.emplace_back(kPareto);
  return parts;
}

SuiteResults run_accuracy_suite(const SuitePlan& plan, const Progress& progress) {
  StabilityPlan stability;
  ParetoPlan pareto;
  if (!plan.is_full()) {
    stability.cases = kQuickCases;
    stability.step_hz = {60, 240};
    stability.standing_s = 0;
    pareto.substeps = {4, 8};
    pareto.iterations = {10};
    pareto.nodes = false;
  }
  if (!plan.only.empty()) stability.cases = plan.only;
  SuiteResults results;
  if (plan.only != std::vector<std::string>{kPareto}) {
    const auto rows = run_stability(stability, [&](double share) { return progress(kStabilityShare * share); });
    add_stability_rows(rows, results.rows);
    add_targets(results, stability_targets(rows));
  }
  if (!plan.wants(kPareto)) return results;
  const auto points =
      run_pareto(pareto, [&](double share) { return progress(kStabilityShare + (1 - kStabilityShare) * share); });
  add_pareto_rows(points, results.rows);
  add_targets(results, pareto_targets(points));
  return results;
}

}  // namespace aurasim::lab
