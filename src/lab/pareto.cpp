#include "lab/pareto.h"

#include <algorithm>
#include <cmath>

#include "config/presets.h"
#include "lab/stability/stability.h"
#include "physics/solver_names.h"

namespace aurasim::lab {
namespace {

/// Errors below this count as this, so that one perfect case does not outweigh the others.
constexpr double kSmallest = 1e-6;
/// Length of each case.
constexpr double kSimulated_s = 3;

struct PlannedRun {
  RunRules rules;
  int nodes = 1;
};

bool knows_iterations(physics::Solver solver) { return solver != physics::Solver::kSoftStep; }
bool knows_directions(physics::Solver solver) { return solver != physics::Solver::kSoftStep; }

bool same_physics(const RunRules& a, const RunRules& b) {
  return a.solver == b.solver && a.substeps == b.substeps &&
         (a.iterations == b.iterations || !knows_iterations(a.solver)) &&
         (a.friction_directions == b.friction_directions || !knows_directions(a.solver));
}

std::vector<PlannedRun> physics_points(const ParetoPlan& plan) {
  std::vector<PlannedRun> points;
  RunRules rules;
  for (const auto& [solver, name] : physics::kSolverNames) {
    rules.solver = solver;
    for (const int directions : {1, 2}) {
      if (!knows_directions(solver) && directions != 1) continue;
      rules.friction_directions = directions;
      for (const int substeps : plan.substeps) {
        rules.substeps = substeps;
        for (const int iterations : plan.iterations) {
          if (!knows_iterations(solver) && iterations != plan.iterations.front()) continue;
          rules.iterations = iterations;
          points.push_back({rules, 1});
        }
      }
    }
  }
  for (const config::Preset& preset : config::kPresets) {
    const RunRules wanted = preset_rules(preset.name);
    const bool is_there =
        std::any_of(points.begin(), points.end(), [&](const PlannedRun& p) { return same_physics(p.rules, wanted); });
    if (!is_there) points.push_back({wanted, 1});
  }
  return points;
}

std::vector<PlannedRun> node_points() {
  std::vector<PlannedRun> points;
  for (const int nodes : {1, 2, 4}) {
    for (const core::SyncMode sync :
         {core::SyncMode::kFreeRunning, core::SyncMode::kBounded, core::SyncMode::kDeterministic}) {
      for (const int lookahead : {1, 2}) {
        for (const core::AuraKind aura : {core::AuraKind::kTight, core::AuraKind::kSwept}) {
          RunRules rules = preset_rules("balanced");
          rules.sync = sync;
          rules.lookahead = lookahead;
          rules.aura = aura;
          const bool is_the_preset =
              nodes == 1 && sync == RunRules{}.sync && lookahead == RunRules{}.lookahead && aura == RunRules{}.aura;
          if (!is_the_preset) points.push_back({rules, nodes});
        }
      }
    }
  }
  return points;
}

std::vector<Case> pareto_cases() {
  std::vector<Case> cases;
  for (const ParetoError& error : pareto_errors()) {
    const bool is_there =
        std::any_of(cases.begin(), cases.end(), [&](const Case& c) { return c.name == error.case_name; });
    if (!is_there) cases.push_back(stability_case(error.case_name));
  }
  for (Case& c : cases) c.duration_s = std::min(c.duration_s, kSimulated_s);
  return cases;
}

std::string preset_of(const PlannedRun& planned) {
  std::string names;
  for (const config::Preset& preset : config::kPresets) {
    if (planned.nodes == 1 && same_physics(preset_rules(preset.name), planned.rules)) names += preset.name;
  }
  return names;
}

ParetoPoint measure(const PlannedRun& planned, const std::vector<Case>& cases) {
  ParetoPoint point;
  point.rules = planned.rules;
  point.nodes = planned.nodes;
  point.preset = preset_of(planned);
  for (const Case& c : cases) {
    const bool one = planned.nodes == 1;
    const MeasuredRun run = run_case(c, planned.rules, one ? one_node() : columns_at(c.border_x_m, planned.nodes));
    point.cpu_us_per_step += run.cpu_us_per_step;
    if (!one) point.same_bits = point.same_bits && run.hash == run_case(c, planned.rules, one_node()).hash;
    for (const ParetoError& error : pareto_errors()) {
      if (c.name == error.case_name) point.errors.push_back(run.errors[error.metric]);
    }
  }
  double logarithms = 0;
  for (const double error : point.errors) logarithms += std::log(std::max(kSmallest, error));
  point.error = std::exp(logarithms / static_cast<double>(point.errors.size()));
  return point;
}

/// True for points that vary the physics. The others have a preset's physics, and would only show the scatter of CPU
/// times.
bool is_about_physics(const ParetoPoint& p) {
  const RunRules usual;
  return p.nodes == 1 && p.rules.sync == usual.sync && p.rules.lookahead == usual.lookahead &&
         p.rules.aura == usual.aura;
}

}  // namespace

const std::vector<ParetoError>& pareto_errors() {
  static const std::vector<ParetoError> errors = {{"stack_10_drift_m", "stack_10", 0},
                                                  {"stack_10_sunk_m", "stack_10", 2},
                                                  {"mass_ratio_100_drift_m", "mass_ratio_100", 0},
                                                  {"newtons_cradle_energy", "newtons_cradle", 0},
                                                  {"chain_50_gap_m", "chain_50", 0},
                                                  {"card_house_drift_m", "card_house", 0}};
  return errors;
}

void mark_front(std::vector<ParetoPoint>& points) {
  for (ParetoPoint& p : points) {
    p.on_front = is_about_physics(p) && std::none_of(points.begin(), points.end(), [&](const ParetoPoint& other) {
                   return is_about_physics(other) && other.error <= p.error &&
                          other.cpu_us_per_step <= p.cpu_us_per_step &&
                          (other.error < p.error || other.cpu_us_per_step < p.cpu_us_per_step);
                 });
  }
}

std::vector<ParetoPoint> run_pareto(const ParetoPlan& plan, const Progress& progress) {
  std::vector<PlannedRun> planned = physics_points(plan);
  if (plan.nodes) {
    for (const PlannedRun& point : node_points()) planned.push_back(point);
  }
  const std::vector<Case> cases = pareto_cases();
  std::vector<ParetoPoint> points;
  for (const PlannedRun& point : planned) {
    if (!progress(static_cast<double>(points.size()) / static_cast<double>(planned.size()))) break;
    points.push_back(measure(point, cases));
  }
  mark_front(points);
  return points;
}

std::vector<Target> pareto_targets(const std::vector<ParetoPoint>& points) {
  double other_bits = 0;
  for (const ParetoPoint& p : points) {
    if (p.rules.sync == core::SyncMode::kDeterministic && !p.same_bits) ++other_bits;
  }
  return {{"deterministic points whose bits differ from those of one node", other_bits, 0}};
}

}  // namespace aurasim::lab
