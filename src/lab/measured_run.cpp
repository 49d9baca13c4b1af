#include "lab/measured_run.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lab/virtual_cluster.h"

namespace aurasim::lab {
namespace {

ClusterRules cluster_rules(const Case& c, const RunRules& rules) {
  ClusterRules cluster;
  cluster.aura.kind = rules.aura;
  cluster.aura.step_s = 1.0 / rules.step_hz;
  cluster.aura.substeps = rules.substeps;
  cluster.aura.lookahead = rules.lookahead;
  cluster.aura.uncertainty = c.uncertainty;
  cluster.aura.gravity = c.scene.gravity;
  cluster.aura.redo = rules.sync == core::SyncMode::kDeterministic;  // as in a real run
  cluster.sync = rules.sync;
  cluster.physics.solver = rules.solver;
  cluster.physics.solver_iterations = rules.iterations;
  cluster.physics.friction_directions = rules.friction_directions;
  cluster.physics.block_m = rules.block_m;
  cluster.physics.contact_erp = c.contact_erp;
  cluster.physics.continuous = c.continuous.value_or(cluster.physics.looks_once());
  cluster.hash_states = true;
  return cluster;
}

/// Puts the nodes' parts of each state together and measures the whole ones, in order.
class Meter {
 public:
  Meter(const Case& c, const RunRules& rules, core::Step steps)
      : case_(c), step_s_(1.0 / rules.step_hz), substep_s_(step_s_ / rules.substeps), steps_(steps) {
    sums_.assign(c.metrics.size(), 0);
  }

  /// Takes in a region's bodies of the report's state. After a redo it replaces what it took in before.
  void see(const node::StepReport& report, core::RegionId region, std::span<const core::BodyRecord> hosted) {
    if (report.step > steps_ || report.step <= measured_until_) return;
    std::vector<core::BodyRecord>& bodies = waiting_[report.step][region];
    bodies.assign(hosted.begin(), hosted.end());
    for (std::size_t i = 0; i < report.departed.size(); ++i) {
      if (report.departures[i].stamp == report.step) bodies.push_back(report.departed[i]);
    }
  }

  /// Measures the states up to `confirmed`, which no redo can change any more.
  void measure_until(core::Step confirmed) {
    for (; !waiting_.empty() && waiting_.begin()->first <= confirmed; waiting_.erase(waiting_.begin())) {
      const auto& [step, parts] = *waiting_.begin();
      std::vector<core::BodyRecord> bodies;
      for (const auto& [region, part] : parts) bodies.insert(bodies.end(), part.begin(), part.end());
      std::ranges::sort(bodies, {}, &core::BodyRecord::id);
      if (bodies.size() == case_.scene.bodies.size()) measure(step, bodies);
      measured_until_ = step;
    }
  }

  std::vector<double> errors() const {
    std::vector<double> errors = sums_;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (case_.metrics[i].over == Over::kMean) errors[i] /= static_cast<double>(std::max(1, measured_));
    }
    return errors;
  }

 private:
  void measure(core::Step step, std::span<const core::BodyRecord> bodies) {
    const Moment now{static_cast<double>(step) * step_s_, substep_s_, bodies};
    ++measured_;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const Metric& metric = case_.metrics[i];
      if (metric.over == Over::kLast && step < steps_) continue;
      const double error = metric.error(now);
      const bool worse = !(error <= sums_[i]);  // true for NaN, too
      if (metric.over == Over::kMean) {
        sums_[i] += error;
      } else if (metric.over == Over::kLast || worse) {
        sums_[i] = error;
      }
    }
  }

  const Case& case_;
  double step_s_;
  double substep_s_;
  core::Step steps_;
  int measured_ = 0;
  core::Step measured_until_ = -1;
  std::vector<double> sums_;
  std::map<core::Step, std::map<core::RegionId, std::vector<core::BodyRecord>>> waiting_;
};

}  // namespace

core::RegionMap one_node() { return core::RegionMap::columns(1, 1); }

core::RegionMap columns_at(double border_x_m, int count) {
  constexpr double kWide = 1000;
  std::vector<core::Rectangle> boxes;
  for (int i = 0; i < count; ++i) {
    const double x0 = border_x_m + kWide * (i - count / 2);
    boxes.push_back({x0, -kWide, x0 + kWide, kWide});
  }
  return core::RegionMap::boxes(boxes);
}

MeasuredRun run_case(const Case& c, const RunRules& rules, const core::RegionMap& map) {
  MeasuredRun run;
  run.steps = static_cast<core::Step>(std::lround(c.duration_s * rules.step_hz));
  run.hash.assign(static_cast<std::size_t>(run.steps) + 1, 0);
  const core::Step more = 4 * rules.lookahead + 2;  // by then, all bodies under way have arrived
  VirtualCluster cluster(c.scene, map, cluster_rules(c, rules));
  Meter meter(c, rules, run.steps);
  std::vector<double> cpu_s(cluster.size(), 0);
  const auto note = [&run](std::span<const node::StepReport> reports) {
    for (const node::StepReport& report : reports) {
      for (const node::HashPart& part : report.hash) {
        if (part.step <= run.steps) run.hash[static_cast<std::size_t>(part.step)] += part.sum;
      }
      run.hand_offs += report.departures.size();
    }
  };
  while (cluster.slowest() < run.steps + more || cluster.confirmed() < run.steps) {
    const double before = thread_time_s();
    const VirtualCluster::Event event = cluster.next();
    cpu_s[core::value_of(event.region)] += thread_time_s() - before;
    note(cluster.node(core::value_of(event.region)).confirmed());
    meter.see(*event.report, event.region, cluster.records(core::value_of(event.region)));
    meter.measure_until(std::min(cluster.confirmed(), cluster.slowest()));
  }
  for (std::size_t r = 0; r < cluster.size(); ++r) note(cluster.node(r).finish(run.steps + more));
  run.errors = meter.errors();
  run.cpu_us_per_step = 1e6 * *std::max_element(cpu_s.begin(), cpu_s.end()) / static_cast<double>(run.steps + more);
  run.violations = cluster.violations();
  return run;
}

}  // namespace aurasim::lab
