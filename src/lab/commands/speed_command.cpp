// `aurasim-lab experiment speed` and `speed-errors`.
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command_line/exit_code.h"
#include "host/stop_signal.h"
#include "host/version.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/speed/speed.h"
#include "lab/suites/results_file.h"
#include "lab/suites/speed_rows.h"

namespace aurasim::lab::commands {
namespace {

void print_speed(const lab::SpeedRun& run) {
  const bool alone = run.threads == 1;
  const double ms = alone ? run.cpu_ms : run.wall_ms, late_ms = alone ? run.late_cpu_ms : run.late_wall_ms;
  fmt::print("{:<12} {:<24} {:>10.3f} {:>10.3f} {:>12.0f}\n", run.scene, run.engine,
             ms / static_cast<double>(run.steps), late_ms / static_cast<double>(run.late_steps),
             1e3 * run.body_steps / ms);
}

int run_speed(const lab::SpeedPlan& plan, const std::string& out) {
  host::catch_stop_signals();
  const auto begin = std::chrono::steady_clock::now();
  ProgressBar bar;
  const auto runs = lab::run_speed(plan, out, [&](double share) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    bar.show({share, elapsed_s, share > 0 ? elapsed_s * (1 - share) / share : 0});
    return !host::stop_requested();
  });
  bar.end();
  if (!runs.empty()) {
    fmt::print("{:<12} {:<24} {:>10} {:>10} {:>12}\n", "scene", "settings", plan.threads == 1 ? "CPU ms" : "wall ms",
               "at the end", "body-steps/s");
  }
  for (const lab::SpeedRun& run : runs) print_speed(run);
  return static_cast<int>(host::stop_requested() ? command_line::ExitCode::kFailed : command_line::ExitCode::kOk);
}

}  // namespace

void add_speed(CLI::App& experiments, command_line::Action& action) {
  CLI::App* command = experiments.add_subcommand("speed", "CPU time of a step in scenes that other engines run, too");
  const auto plan = std::make_shared<lab::SpeedPlan>();
  const auto out = std::make_shared<std::string>();
  const auto quick = std::make_shared<bool>(false);
  std::vector<std::string> settings;
  for (const lab::SpeedSettings& known : lab::speed_settings()) settings.push_back(known.name);
  command->add_option("--out", *out, "folder for the results; runs.csv goes on where there is one")->required();
  command->add_option("--cases", plan->scenes, "only these")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::speed_scene_names()));
  command->add_option("--settings", plan->settings, "of the step")->delimiter(',')->check(CLI::IsMember(settings));
  command->add_option("--solver", plan->solver, "instead of that of the settings")
      ->check(CLI::IsMember(solver_names()));
  command->add_option("--threads", plan->threads, "of the soft step; with several, times are by the clock")
      ->check(CLI::Range(1, 64));
  command->add_option("--repeats", plan->repeats, "runs of each, by turns; 0 writes the scenes only")
      ->check(CLI::Range(0, 1000));
  command->add_flag("--quick", *quick, "small scenes");
  command->footer("Example:\n  aurasim-lab experiment speed --cases pyramid --settings fast,balanced --out out");
  command->callback([plan, out, quick, &action] {
    if (*quick) plan->size = lab::SceneSize::kQuick;
    action = [plan, out] { return run_speed(*plan, *out); };
  });
}

void add_speed_errors(CLI::App& experiments, command_line::Action& action) {
  CLI::App* command =
      experiments.add_subcommand("speed-errors", "what is wrong with the states that runs of any engine have left");
  const auto out = std::make_shared<std::string>(), results = std::make_shared<std::string>();
  command->add_option("--out", *out, "folder with scenes and states; gets errors.csv")->required();
  command->add_option("--results", *results, "also append times and errors to speed.jsonl in this folder");
  command->footer("Example:\n  aurasim-lab experiment speed-errors --out out");
  command->callback([out, results, &action] {
    action = [out, results] {
      lab::write_speed_errors(*out);
      if (!results->empty()) {
        lab::append_results(std::filesystem::path(*results) / "speed.jsonl", lab::speed_rows(*out),
                            lab::provenance_here(host::commit(), false));
      }
      return static_cast<int>(command_line::ExitCode::kOk);
    };
  });
}

}  // namespace aurasim::lab::commands
