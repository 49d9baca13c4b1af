#include "lab/commands/rain_processes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "host/spawn.h"
#include "lab/scale/rain_run.h"
#include "records/report_rows.h"
#include "setup/launch_setup.h"

namespace aurasim::lab::commands {
namespace {

/// Runs a program and waits for its end. True if it succeeded.
bool run_program(std::vector<std::string> words) {
  const pid_t pid = host::spawn(std::move(words));
  int status = 0;
  while (::waitpid(pid, &status, 0) != pid) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

lab::StepLoad load_of(const records::StepRow& row) {
  lab::StepLoad load;
  load.physics_ms = row.physics_ms;
  load.protocol_ms = row.protocol_ms;
  load.transport_ms = row.transport_ms;
  load.other_ms = std::max(0.0, row.frame_ms - load.frame_ms());
  load.bodies = row.bodies;
  load.projecting = row.projecting;
  load.largest_cluster = row.largest_cluster;
  load.departures = row.hand_offs_out;
  load.violations = row.violations;
  return load;
}

}  // namespace

std::vector<lab::Window> windows_of_report(const std::filesystem::path& report, std::size_t regions, double step_s) {
  lab::WindowSums sums(regions, std::llround(lab::kWindow_s / step_s));
  std::vector<std::uint64_t> violations(regions, 0);
  records::read_csv<records::StepRow>(report / "steps.csv", [&](const records::StepRow& row) {
    if (row.step == 0) return;
    const std::size_t region = core::value_of(row.region);
    lab::StepLoad load = load_of(row);
    const std::uint64_t so_far = load.violations;  // since the start
    load.violations -= violations.at(region);
    violations[region] = so_far;
    sums.add(region, row.step, load);
  });
  std::vector<lab::Window> windows = sums.windows();
  std::ifstream in(report / "summary.json");
  const double real_time_factor = nlohmann::json::parse(in).value("real_time_factor", 0.0);
  for (lab::Window& window : windows) window.slow_down = real_time_factor > 0 ? 1 / real_time_factor : 0;
  return windows;
}

std::optional<std::vector<lab::Window>> run_processes(const lab::Rain& rain, const std::filesystem::path& launch_file,
                                                      const std::filesystem::path& report) {
  const std::vector<std::string> overrides = rain.overrides();
  const config::Launch launch = config::read_launch(launch_file, overrides);
  std::filesystem::create_directories(report);
  std::vector<std::string> words = {setup::program_beside("aurasim", "`scripts/build.sh release` builds it.").string(),
                                    "launch",
                                    launch_file.string(),
                                    "--headless",
                                    "--steps",
                                    std::to_string(rain.steps(launch.step_s())),
                                    "--report",
                                    report.string()};
  for (const std::string& change : overrides) words.insert(words.end(), {"--set", change});
  if (!run_program(std::move(words))) return std::nullopt;
  return windows_of_report(report, launch.regions.size(), launch.step_s());
}

}  // namespace aurasim::lab::commands
