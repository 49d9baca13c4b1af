// stability.csv and summary.json.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "lab/stability/stability.h"
#include "physics/region_world.h"

namespace aurasim::lab {
namespace {

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::ofstream open_file(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw std::runtime_error("cannot write " + file.string());
  return out;
}

void write_csv(const std::vector<StabilityRow>& rows, const std::filesystem::path& file) {
  std::ofstream out = open_file(file);
  out << "case,measured,unit,reference,seed,simulated_s,step_hz,substeps,iterations,friction_directions,preset,"
         "error_one_node,error_two_nodes,same_bits,first_difference_step,hand_offs,cpu_us_per_step\n";
  for (const StabilityRow& row : rows) {
    for (std::size_t i = 0; i < row.what.metrics.size(); ++i) {
      const Metric& metric = row.what.metrics[i];
      out << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{},{},{},{:.2f}\n", row.what.name,
                         quoted(metric.measured), metric.unit, quoted(row.what.reference), row.what.seed,
                         row.what.duration_s, row.rules.step_hz, row.rules.substeps, row.rules.iterations,
                         row.rules.friction_directions, row.preset, row.one.errors[i], row.two.errors[i],
                         row.same_bits() ? 1 : 0, row.first_difference(), row.two.hand_offs, row.one.cpu_us_per_step);
    }
  }
}

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

std::vector<Target> write_stability(const std::vector<StabilityRow>& rows, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  write_csv(rows, directory / "stability.csv");
  const std::vector<Target> targets = stability_targets(rows);
  nlohmann::json summary;
  summary["runs"] = rows.size();
  summary["targets"] = json_of(targets);
  open_file(directory / "summary.json") << summary.dump(2) << "\n";
  return targets;
}

}  // namespace aurasim::lab
