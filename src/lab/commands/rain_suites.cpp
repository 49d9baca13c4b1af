// The suites scalability and many_nodes (virtual time), and scalability_clock (processes over DDS by the wall clock).
#include "lab/commands/rain_suites.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "config/shipped_files.h"
#include "lab/commands/rain_processes.h"
#include "lab/scale/fit.h"
#include "lab/scale/many_nodes.h"
#include "lab/scale/message_sizes.h"
#include "lab/scale/rain_summary.h"
#include "lab/scale/scalability.h"
#include "setup/launch_setup.h"

namespace aurasim::lab::commands {
namespace {

constexpr int kRunsAtATime = 2;
constexpr double kStep_ms = 1000.0 / 60;

std::filesystem::path rain_launch_file() { return config::shipped_folder() / "launch_configs" / "columns_rain.yaml"; }

/// What one repeat of a run was measured to be, by metric.
struct Figure {
  const char* metric;
  const char* unit;
  double value;
};

/// Bodies up to which the mean frame of every window so far was within a step.
double bodies_in_real_time(const std::vector<Window>& windows) {
  double bodies = 0;
  for (const Window& w : windows) {
    if (w.frame_mean_ms > kStep_ms) break;
    bodies = static_cast<double>(w.bodies);
  }
  return bodies;
}

std::vector<Figure> figures(const RainFigures& f) {
  const auto count = [](auto n) { return static_cast<double>(n); };
  return {{"bodies", "1", count(f.last.bodies)},
          {"largest frame", "ms", f.frame_max_ms},
          {"95th percentile", "ms", f.frame_p95_ms},
          {"last 5 s", "ms", f.last.frame_mean_ms},
          {"physics, all nodes", "ms", f.last.physics_ms},
          {"protocol", "ms", f.last.protocol_ms},
          {"transport", "ms", f.last.transport_ms},
          {"(protocol + transport) / physics", "ratio", f.overhead_share},
          {"projecting bodies", "1", count(f.last.projecting)},
          {"handed over", "1", count(f.departures)},
          {"back within a second", "%", 100 * count(f.returns) / std::max(1.0, count(f.departures))},
          {"largest cluster", "1", count(f.largest_cluster)},
          {"most hosted over mean", "1", f.most_hosted_share},
          {"violations", "1", count(f.violations)}};
}

std::vector<Figure> traffic(const Rain& rain, const RainFigures& f) {
  const double node_steps = static_cast<double>(rain.regions.count) * static_cast<double>(rain.steps(1.0 / 60));
  const auto per = [](std::uint64_t n, double of) { return static_cast<double>(n) / std::max(1.0, of); };
  return {{"bytes per node and step", "B", per(f.link_bytes, node_steps)},
          {"datagrams per node and step", "1", per(f.datagrams, node_steps)},
          {"bytes per aura message", "B", per(f.aura_bytes, static_cast<double>(f.aura_updates))},
          {"bytes per body handed over", "B", per(f.hand_off_bytes, static_cast<double>(f.departures))},
          {"time taken over simulated", "1", f.last.slow_down}};
}

std::vector<Figure> figures(const NodeCosts& costs) {
  return {{"messages", "1", costs.messages},
          {"bytes", "B", costs.bytes},
          {"physics", "us", costs.physics_us},
          {"protocol", "us", costs.protocol_us},
          {"transport", "us", costs.transport_us},
          {"memory of a node", "kB", costs.memory_kB},
          {"bodies of a node", "1", costs.bodies},
          {"hand-offs a second", "1", costs.hand_offs},
          {"redos", "1", static_cast<double>(costs.redos)}};
}

/// The case of a run, without its repeat. '/' divides the parts of a case, so units are in words.
std::string case_of(const Rain& rain, const std::string& group) {
  std::string what;
  if (rain.series == "columns" || rain.series == "cuts") {
    what = fmt::format("{} nodes, {}", rain.regions.count, rain.aura);
  } else if (rain.series == "border") {
    what = fmt::format("{:g}% near the border", 100 * rain.border_share);
  } else if (rain.series == "uncertainty") {
    what = fmt::format("U = {:g}", rain.uncertainty);
  } else if (rain.series == "lookahead") {
    what = fmt::format("K = {}", rain.lookahead);
  } else if (rain.series == "weak") {
    what = fmt::format("{} nodes", rain.regions.count);
  } else if (rain.series == "speed") {
    what = fmt::format("{:g} m a second per axis, {}", rain.fall_m_s, rain.aura);
  } else if (rain.series == "link") {
    what = fmt::format("{:g} kB a second, {}", rain.bandwidth_B_s / 1e3, rain.aura);
  } else {
    what = rain.regions.name();
  }
  return rain.series + group + "/" + what;
}

/// Gathers the repeats of each case, and gives their medians.
class Medians {
 public:
  void add(const std::string& what, const Figure& figure) {
    const auto key = std::pair{what, std::string(figure.metric)};
    if (values_.find(key) == values_.end()) order_.emplace_back(key, figure.unit);
    values_[key].push_back(figure.value);
  }
  void rows_into(std::vector<ResultRow>& out) const {
    for (const auto& [key, unit] : order_) {
      const std::vector<double>& all = values_.at(key);
      out.push_back({key.first, key.second, median(all), unit, static_cast<int>(all.size())});
    }
  }

 private:
  std::vector<std::pair<std::pair<std::string, std::string>, std::string>> order_;
  std::map<std::pair<std::string, std::string>, std::vector<double>> values_;
};

/// Rains, and the windows of each.
struct Runs {
  std::vector<Rain> rains;
  std::vector<std::vector<Window>> windows;
};

/// How many times less the frames of several nodes take than those of the same rain on one node.
std::vector<Figure> gains(const RainFigures& one, const RainFigures& f) {
  return {{"largest frame, times less", "ratio", one.frame_max_ms / f.frame_max_ms},
          {"95th percentile, times less", "ratio", one.frame_p95_ms / f.frame_p95_ms},
          {"last 5 s, times less", "ratio", one.last.frame_mean_ms / f.last.frame_mean_ms},
          {"growth per body, times less", "ratio", one.growth_per_body / f.growth_per_body}};
}

/// Each run in numbers, and beside the same rain on one node.
void add_runs(const Runs& runs, const std::string& group, bool is_traffic, std::vector<ResultRow>& out) {
  Medians medians;
  for (std::size_t i = 0; i < runs.rains.size(); ++i) {
    const Rain& rain = runs.rains[i];
    const std::string what = case_of(rain, group);
    const RainFigures f = figures_of(runs.windows[i], rain.regions.count);
    for (const Figure& figure : is_traffic ? traffic(rain, f) : figures(f)) medians.add(what, figure);
    medians.add(what, {"bodies in real time", "1", bodies_in_real_time(runs.windows[i])});
    if (rain.regions.count == 1 || (rain.series != "columns" && rain.series != "cuts")) continue;
    for (std::size_t k = 0; k < runs.rains.size(); ++k) {
      const Rain& other = runs.rains[k];
      if (other.regions.count != 1 || other.series != rain.series || other.repeat != rain.repeat) continue;
      for (const Figure& gain : gains(figures_of(runs.windows[k], 1), f)) medians.add(what, gain);
    }
  }
  medians.rows_into(out);
}

/// One part of the suite: a plan, and what its cases are called.
struct Part {
  std::string group;
  ScalabilityPlan plan;
  bool is_traffic = false;
};

/// The parts of a full run. A quick run has two series of the shorter one. If series are named, other series and parts
/// without any are left out.
std::vector<Part> parts_of(const SuitePlan& wanted) {
  ScalabilityPlan shorter, wide, narrow, bandwidth;
  shorter.run_s = 20;
  bandwidth.series = bandwidth_series();
  bandwidth.run_s = 10;
  wide.series = {"columns", "cuts"};
  wide.auras = {"swept"};
  wide.repeats = 3;
  narrow = wide;
  narrow.series = {"columns"};
  narrow.columns = {1, 2, 4, 8};
  narrow.lookahead = 1;
  std::vector<Part> parts = {{", K = 2", wide}, {", K = 1", narrow}, {", 20 s", shorter}, {"", bandwidth, true}};
  if (!wanted.is_full()) {
    if (wanted.only.empty()) shorter.series = {"border", "lookahead"};
    parts = {{", 20 s", shorter}, {"", bandwidth, true}};
    if (wanted.only.empty()) parts.pop_back();
  }
  for (Part& part : parts) std::erase_if(part.plan.series, [&](const auto& series) { return !wanted.wants(series); });
  std::erase_if(parts, [](const Part& part) { return part.plan.series.empty(); });
  return parts;
}

double found_in(const std::vector<ResultRow>& rows, const std::string& what, const std::string& metric) {
  for (const ResultRow& row : rows) {
    if (row.what == what && row.metric == metric) return row.value;
  }
  throw std::logic_error("the suite scalability has no " + what);
}

/// What several nodes are for. docs/speed.md names what is wanted beyond it.
void add_requirements(SuiteResults& results) {
  const auto& rows = results.rows;
  std::vector<Target> targets;
  for (const char* k : {"2", "1"}) {
    for (const auto& [nodes, wanted] : {std::pair{4, 7}, std::pair{8, 14}}) {
      const double found =
          found_in(rows, fmt::format("columns, K = {}/{} nodes, swept", k, nodes), "largest frame, times less");
      targets.push_back({fmt::format("largest frame, {} nodes against 1, columns, K = {}", nodes, k), found,
                         static_cast<double>(wanted), true});
    }
  }
  targets.push_back({"bytes of an aura update, tight", found_in(rows, "size/each aura update, tight", "bytes"), 40});
  targets.push_back({"bytes of an aura update, swept", found_in(rows, "size/each aura update, swept", "bytes"), 80});
  add_targets(results, targets);
}

RainPlace rain_place() {
  return {rain_launch_file(),
          [](const config::Launch& launch, core::RegionId region) { return setup::node_setup(launch, region, 0); }};
}

SuiteResults run_scalability(const SuitePlan& wanted, const Progress& progress) {
  const RainPlace place = rain_place();
  SuiteResults results;
  const std::vector<Part> parts = parts_of(wanted);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::vector<Rain> rains = rains_of(parts[i].plan);
    auto windows = run_rains(rains, place, kRunsAtATime, [&](double share) {
      return progress((static_cast<double>(i) + share) / static_cast<double>(parts.size()));
    });
    if (!windows) return results;
    add_runs({rains, std::move(*windows)}, parts[i].group, parts[i].is_traffic, results.rows);
  }
  for (const ResultRow& size : message_sizes()) results.rows.push_back(size);
  if (wanted.is_full() && wanted.only.empty()) add_requirements(results);
  return results;
}

std::vector<std::string> scalability_parts() {
  std::vector<std::string> parts = scalability_series();
  for (const std::string& series : bandwidth_series()) parts.push_back(series);
  return parts;
}

/// A grid of so many nodes on a side. A quick run has the smallest.
const std::vector<std::size_t> kSides = {3, 8, 16, 32};

SuiteResults run_many_nodes(const SuitePlan& wanted, const Progress& progress) {
  const RainPlace place = rain_place();
  SuiteResults results;
  std::map<std::size_t, NodeCosts> all;
  for (const bool coupled : {false, true}) {
    for (std::size_t i = 0; i < kSides.size(); ++i) {
      ManyNodes many;
      many.side = kSides[i];
      many.coupled = coupled;
      if (!wanted.is_full() && many.side > 8) break;
      const auto shown = [&](double share) {
        const double of_half = (static_cast<double>(i) + share) / static_cast<double>(kSides.size());
        return progress((of_half + (coupled ? 1 : 0)) / 2);
      };
      const std::optional<NodeCosts> costs = measure_many_nodes(many, place, shown);
      if (!costs) return results;
      const std::string what = fmt::format("{}/{} nodes", coupled ? "coupled" : "grid", many.nodes());
      for (const Figure& figure : figures(*costs))
        results.rows.push_back({what, figure.metric, figure.value, figure.unit});
      all[many.nodes()] = *costs;
    }
    if (!wanted.is_full()) continue;
    const char* const kind = coupled ? ", coupled" : "";
    add_targets(results, {{fmt::format("messages of a node and step, 1024 nodes over 64{}", kind),
                           all[1024].messages / all[64].messages, 1.2},
                          {fmt::format("bytes of a node and step, 1024 nodes over 64{}", kind),
                           all[1024].bytes / all[64].bytes, 1.2}});
  }
  return results;
}

/// One and two nodes. A quick run has one repeat with K = 1.
SuiteResults run_scalability_clock(const SuitePlan& wanted, const Progress& progress) {
  ScalabilityPlan plan;
  plan.series = {"columns"};
  plan.columns = {1, 2};
  plan.auras = {"swept"};
  plan.repeats = wanted.is_full() ? 3 : 1;
  SuiteResults results;
  double done = 0;
  const std::vector<int> lookaheads = wanted.is_full() ? std::vector{2, 1} : std::vector{1};
  for (const int k : lookaheads) {
    plan.lookahead = k;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("aurasim-lab-{}", ::getpid());
    Runs runs{rains_of(plan), {}};
    for (const Rain& rain : runs.rains) {
      if (!progress(done++ / static_cast<double>(lookaheads.size() * runs.rains.size()))) return results;
      const auto windows = run_processes(rain, rain_launch_file(), folder);
      std::filesystem::remove_all(folder);
      if (!windows) throw std::runtime_error("the run " + rain.name() + " failed; what it wrote is above");
      runs.windows.push_back(*windows);
    }
    add_runs(runs, fmt::format(", K = {}, {:g} s", k, plan.run_s), false, results.rows);
  }
  return results;
}

}  // namespace

std::vector<Suite> rain_suites() {
  return {{"scalability", "rain on 1 to 10 nodes, CPU time in virtual time (docs/speed.md)", run_scalability,
           scalability_parts},
          {"many_nodes", "9 to 1,024 nodes of a world that grows with them, in virtual time (docs/speed.md)",
           run_many_nodes, [] { return std::vector<std::string>(); }},
          {"scalability_clock", "rain on one and two real nodes, by the wall clock (docs/speed.md)",
           run_scalability_clock, [] { return std::vector<std::string>(); }}};
}

}  // namespace aurasim::lab::commands
