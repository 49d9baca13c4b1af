#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "config/shipped_files.h"
#include "host/stop_signal.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/rain_processes.h"
#include "lab/scale/message_sizes.h"
#include "lab/scale/rain_summary.h"
#include "lab/scale/scalability.h"
#include "setup/launch_setup.h"

namespace aurasim::lab::commands {
namespace {

struct RainArguments {
  lab::ScalabilityPlan plan;
  std::filesystem::path launch_file = config::shipped_folder() / "launch_configs" / "columns_rain.yaml";
  std::filesystem::path out;
  int threads = 2;
  bool processes = false;
  std::vector<std::string> overrides;
};

lab::RainPlace place_of(const RainArguments& arguments) {
  lab::RainPlace place;
  place.launch_file = arguments.launch_file;
  place.setup_of = [](const config::Launch& launch, core::RegionId region) {
    return setup::node_setup(launch, region, 0);
  };
  return place;
}

void print_speed_ups(const nlohmann::json& speed_ups) {
  fmt::print("{:<9} {:<7} {:>5}  {:>9} {:>9} {:>9} {:>9} {:>7}\n", "series", "aura", "nodes", "max frame", "p95",
             "last", "fitted", "thesis");
  for (const auto& row : speed_ups) {
    const auto median_of = [&](const char* key) { return row[key]["median"].get<double>(); };
    fmt::print("{:<9} {:<7} {:>5}  {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>7}\n", row["series"].get<std::string>(),
               row["aura"].get<std::string>(), row["nodes"].get<int>(), median_of("frame_max"), median_of("frame_p95"),
               median_of("last_frame"), median_of("fitted"),
               row.contains("thesis") ? fmt::format("{:.2f}", row["thesis"].get<double>()) : "");
  }
}

/// Runs the rains. False when the user has stopped it.
bool run(const std::vector<lab::Rain>& rains, const RainArguments& arguments) {
  host::catch_stop_signals();
  std::atomic<bool> stop = false;
  ProgressBar bar;
  const bool finished = lab::run_rains(
      rains, place_of(arguments), arguments.out, arguments.threads,
      [&](const lab::Progress& progress) {
        bar.show(progress);
        if (host::stop_requested()) stop = true;
      },
      stop);
  bar.end();
  if (!finished) spdlog::warn("stopped; the same command goes on from here");
  return finished;
}

/// Runs the rains one after the other, because they measure the wall clock. False when one of them has failed.
bool run_as_processes(const std::vector<lab::Rain>& rains, const RainArguments& arguments) {
  std::filesystem::create_directories(arguments.out / "runs");
  for (const lab::Rain& rain : rains) {
    const std::filesystem::path file = lab::windows_file(arguments.out, rain);
    if (std::filesystem::exists(file)) continue;
    const auto windows =
        run_processes(rain, arguments.launch_file, arguments.overrides, arguments.out / "reports" / rain.name());
    if (!windows) return false;
    lab::write_windows(file, *windows);
  }
  return true;
}

int exit_code(bool finished) {
  return static_cast<int>(finished ? command_line::ExitCode::kOk : command_line::ExitCode::kFailed);
}

int run_scalability(const RainArguments& arguments) {
  const std::vector<lab::Rain> rains = lab::rains_of(arguments.plan);
  const bool finished = arguments.processes ? run_as_processes(rains, arguments) : run(rains, arguments);
  print_speed_ups(lab::summarise_rains(rains, arguments.out)["speed_up"]);
  return exit_code(finished);
}

int run_bandwidth(const RainArguments& arguments) {
  const std::vector<lab::Rain> rains = lab::rains_of(arguments.plan);
  const bool finished = run(rains, arguments);
  lab::summarise_rains(rains, arguments.out);
  const nlohmann::json sizes = lab::message_sizes();
  std::ofstream(arguments.out / "sizes.json") << sizes.dump(1) << '\n';
  const double tight = sizes["aura_update"]["tight"];
  const double swept = sizes["aura_update"]["swept"];
  fmt::print("{} bytes for each tight aura (at most 40), {} for each swept one (at most 80), {} for a batch of none\n",
             tight, swept, sizes["aura_batch"].get<int>());
  return exit_code(finished && tight <= 40 && swept <= 80);
}

void add_options(CLI::App& command, const std::shared_ptr<RainArguments>& a, const std::vector<std::string>& series) {
  a->plan.series = series;
  command.add_option("--out", a->out, "folder for the results; runs that it holds are not repeated")->required();
  command.add_option("--launch", a->launch_file, "launch file whose rain it is");
  command.add_option("--series", a->plan.series, "what to vary")->delimiter(',')->check(CLI::IsMember(series));
  command.add_option("--aura", a->plan.auras, "auras to try in the series columns, cuts, speed and link")
      ->delimiter(',')
      ->check(CLI::IsMember({"thesis", "tight", "swept"}));
  command.add_option("--rate", a->plan.rate_per_s, "bodies per second")->check(CLI::Range(1.0, 1e4));
  command.add_option("--seconds", a->plan.run_s, "simulated time of each run")->check(CLI::Range(5.0, 3600.0));
  command.add_option("--solver", a->plan.solver, "of the physics")->check(CLI::IsMember(solver_names()));
  command.add_option("--substeps", a->plan.substeps, "physics substeps in each step")->check(CLI::Range(1, 16));
  command.add_option("--lookahead", a->plan.lookahead, "K of runs with several nodes; 0: from the tolerances")
      ->check(CLI::Range(0, 16));
  command.add_option("--repeats", a->plan.repeats, "runs of each kind, each with other bodies")
      ->check(CLI::Range(1, 1000));
  command.add_option("--threads", a->threads, "runs at the same time")->check(CLI::Range(1, 64));
}

}  // namespace

void add_scalability(CLI::App& experiment, command_line::Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "scalability", "rain on 1 to 10 nodes: CPU time of each node and step, in virtual time (thesis 5.1)");
  const auto a = std::make_shared<RainArguments>();
  add_options(*command, a, lab::scalability_series());
  command->add_flag("--processes", a->processes, "real nodes over DDS on this host, by the wall clock");
  command->add_option("--set", a->overrides, "key.path=value, as for launch; with --processes");
  command->add_option("--columns", a->plan.columns, "numbers of columns")->delimiter(',')->check(CLI::Range(1, 64));
  command->footer("Example:\n  aurasim-lab experiment scalability --columns 1,4 --out out");
  command->callback([a, &action] { action = [a] { return run_scalability(*a); }; });
}

void add_bandwidth(CLI::App& experiment, command_line::Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "bandwidth", "bytes of auras and hand-offs by speed and aura, and what narrow links do, in virtual time");
  const auto a = std::make_shared<RainArguments>();
  a->plan.run_s = 10;
  add_options(*command, a, lab::bandwidth_series());
  command->footer("Example:\n  aurasim-lab experiment bandwidth --out out");
  command->callback([a, &action] { action = [a] { return run_bandwidth(*a); }; });
}

}  // namespace aurasim::lab::commands
