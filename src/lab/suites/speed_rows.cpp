#include "lab/suites/speed_rows.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "lab/scale/fit.h"
#include "lab/speed/speed.h"

namespace aurasim::lab {
namespace {

struct Error {
  double SpeedErrors::*value;
  const char* metric;
  double scale;
  const char* unit;
};
constexpr Error kOverlap = {&SpeedErrors::overlap_m, "deepest overlap", 1e3, "mm"};
constexpr Error kInStatic = {&SpeedErrors::in_static_m, "deepest in the ground", 1e3, "mm"};
constexpr Error kSunk = {&SpeedErrors::sunk_m, "most sunk", 1e3, "mm"};
constexpr Error kDrift = {&SpeedErrors::drift_m, "farthest drift", 1, "m"};
constexpr Error kFallen = {&SpeedErrors::fallen, "fallen", 1, "1"};
constexpr Error kLost = {&SpeedErrors::lost, "lost", 1, "1"};
constexpr Error kEnergy = {&SpeedErrors::energy, "energy gained", 100, "%"};
constexpr Error kGap = {&SpeedErrors::joint_gap_m, "widest joint gap", 1e3, "mm"};
constexpr Error kTurn = {&SpeedErrors::hinge_turn_rad, "hinge off axis or limits", 1, "rad"};

/// What is told of a scene beside its speed.
const std::map<std::string, std::vector<Error>> kErrors = {{"rain", {kOverlap, kInStatic, kLost}},
                                                           {"pyramid", {kSunk, kOverlap, kDrift, kFallen}},
                                                           {"hulls", {kOverlap, kInStatic, kLost}},
                                                           {"ragdolls", {kGap, kTurn, kOverlap, kInStatic, kLost}},
                                                           {"card_houses", {kFallen, kSunk, kDrift, kOverlap}},
                                                           {"gas", {kEnergy, kOverlap, kLost}},
                                                           {"sleepers", {kSunk, kDrift, kOverlap}}};

/// All runs of one scene by one engine with one number of threads.
using Runs = std::vector<SpeedRun>;

template <class Value>
double median_of(const Runs& runs, const Value& value) {
  std::vector<double> values;
  for (const SpeedRun& run : runs) values.push_back(value(run));
  return median(std::move(values));
}

/// From the fastest run to the slowest, as a share of the median.
double spread_percent(const Runs& runs) {
  const auto [least, most] = std::ranges::minmax(runs, {}, &SpeedRun::cpu_ms);
  return 100 * (most.cpu_ms - least.cpu_ms) / median_of(runs, [](const SpeedRun& run) { return run.cpu_ms; });
}

std::string case_of(const std::string& scene, const std::string& engine, const std::string& precision,
                    const std::string& threads) {
  return scene + (threads == "1" ? "" : ", " + threads + " threads") + "/" + engine + ", " + precision;
}

std::string case_of(const SpeedRun& run, int threads) {
  return case_of(run.scene, run.engine, run.precision, std::to_string(threads));
}

double wall_ms(const SpeedRun& run) { return run.wall_ms / static_cast<double>(run.steps); }

void add_times(const std::string& what, const Runs& runs, const std::map<std::string, Runs>& all,
               std::vector<ResultRow>& out) {
  const auto add = [&](const char* metric, double value, const char* unit) {
    out.push_back({what, metric, value, unit, static_cast<int>(runs.size())});
  };
  const auto median_per = [&](double SpeedRun::*value, auto SpeedRun::*per) {
    return median_of(runs, [&](const SpeedRun& run) { return run.*value / static_cast<double>(run.*per); });
  };
  add("CPU", median_per(&SpeedRun::cpu_ms, &SpeedRun::steps), "ms");
  if (runs.front().threads == 1) {
    add("CPU at the end", median_per(&SpeedRun::late_cpu_ms, &SpeedRun::late_steps), "ms");
    add("body-steps per CPU second", 1e3 * median_per(&SpeedRun::body_steps, &SpeedRun::cpu_ms), "1");
    add("spread of the CPU time", spread_percent(runs), "%");
    return;
  }
  add("wall", median_of(runs, wall_ms), "ms");
  const auto one = all.find(case_of(runs.front(), 1));
  if (one == all.end()) return;
  add("faster by", median_of(one->second, wall_ms) / median_of(runs, wall_ms), "ratio");
}

}  // namespace

std::vector<ResultRow> speed_rows(const std::filesystem::path& directory) {
  if (!std::filesystem::exists(directory / "runs.csv"))
    throw std::runtime_error("cannot read " + (directory / "runs.csv").string());
  std::map<std::string, Runs> all;
  const std::size_t broken = records::read_csv<SpeedRun>(
      directory / "runs.csv", [&](const SpeedRun& run) { all[case_of(run, run.threads)].push_back(run); });
  if (broken > 0) throw std::runtime_error(fmt::format("{}/runs.csv: {} broken rows", directory.string(), broken));
  std::vector<ResultRow> rows;
  for (const auto& [what, runs] : all) add_times(what, runs, all, rows);
  for (const StateErrors& of : errors_of_states(directory)) {
    const auto wanted = kErrors.find(of.scene);
    if (wanted == kErrors.end()) continue;
    for (const Error& error : wanted->second) {
      rows.push_back({case_of(of.scene, of.engine, of.precision, of.threads), error.metric,
                      error.scale * of.errors.*error.value, error.unit});
    }
  }
  return rows;
}

}  // namespace aurasim::lab
