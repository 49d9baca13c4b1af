#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "cli/launch_setup.h"
#include "cli/node_process.h"
#include "cli/progress_bar.h"
#include "cli/stop_signal.h"
#include "experiment/scale/rain_summary.h"
#include "experiment/scale/scalability.h"

namespace aurasim::cli {
namespace {

struct Arguments {
  experiment::ScalabilityPlan plan;
  std::filesystem::path launch_file = AURASIM_SOURCE_DIR "/launch_configs/columns_rain.yaml";
  std::filesystem::path out;
  int threads = 2;
};

experiment::RainPlace place_of(const Arguments& arguments) {
  experiment::RainPlace place;
  place.launch_file = arguments.launch_file;
  place.setup_of = [](const config::Launch& launch, core::RegionId region) { return node_setup(launch, region, 0); };
  return place;
}

void print(const nlohmann::json& speed_ups) {
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

int run_scalability(const Arguments& arguments) {
  catch_stop_signals();
  std::atomic<bool> stop = false;
  ProgressBar bar;
  const std::vector<experiment::Rain> rains = experiment::rains_of(arguments.plan);
  const bool finished = experiment::run_rains(
      rains, place_of(arguments), arguments.out, arguments.threads,
      [&](const experiment::Progress& progress) {
        bar.show(progress);
        if (stop_requested()) stop = true;
      },
      stop);
  bar.end();
  print(experiment::summarise_rains(rains, arguments.out)["speed_up"]);
  if (finished) return static_cast<int>(ExitCode::kOk);
  spdlog::warn("stopped; the same command goes on from here");
  return static_cast<int>(ExitCode::kFailed);
}

}  // namespace

void add_scalability(CLI::App& experiment, Action& action) {
  CLI::App* command = experiment.add_subcommand(
      "scalability", "rain on 1 to 10 nodes: CPU time of each node and step, in virtual time (thesis 5.1)");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--out", a->out, "folder for the results; runs that it holds are not repeated")->required();
  command->add_option("--launch", a->launch_file, "launch file whose rain it is");
  command->add_option("--series", a->plan.series, "what to vary")
      ->delimiter(',')
      ->check(CLI::IsMember(experiment::scalability_series()));
  command->add_option("--aura", a->plan.auras, "auras to try in the series columns and cuts")
      ->delimiter(',')
      ->check(CLI::IsMember({"thesis", "tight", "swept"}));
  command->add_option("--columns", a->plan.columns, "numbers of columns")->delimiter(',')->check(CLI::Range(1, 64));
  command->add_option("--rate", a->plan.rate_per_s, "bodies per second")->check(CLI::Range(1.0, 1e4));
  command->add_option("--seconds", a->plan.run_s, "simulated time of each run")->check(CLI::Range(5.0, 3600.0));
  command->add_option("--substeps", a->plan.substeps, "physics substeps in each step")->check(CLI::Range(1, 16));
  command->add_option("--repeats", a->plan.repeats, "runs of each kind, each with other bodies")
      ->check(CLI::Range(1, 1000));
  command->add_option("--threads", a->threads, "runs at the same time")->check(CLI::Range(1, 64));
  command->callback([a, &action] { action = [a] { return run_scalability(*a); }; });
}

}  // namespace aurasim::cli
