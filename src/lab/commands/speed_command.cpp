// `aurasim-lab experiment speed` and `speed-errors`.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

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

int run_speed(const lab::SpeedPlan& plan, const std::string& out) {
  ProgressBar bar;
  lab::run_speed(plan, out, std::ref(bar));
  return static_cast<int>(host::stop_requested() ? command_line::ExitCode::kFailed : command_line::ExitCode::kOk);
}

int store_speed(const std::string& directory, const std::string& results) {
  lab::append_results(std::filesystem::path(results.empty() ? directory : results) / "speed.jsonl",
                      lab::speed_rows(directory), lab::provenance_here(host::commit(), false));
  return static_cast<int>(command_line::ExitCode::kOk);
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
  CLI::App* command = experiments.add_subcommand(
      "speed-errors", "the times of the runs of any engine, and what is wrong with the states that they have left");
  const auto out = std::make_shared<std::string>(), results = std::make_shared<std::string>();
  command->add_option("--out", *out, "folder with runs.csv, scenes and states")->required();
  command->add_option("--results", *results, "folder whose speed.jsonl gets the rows, if it is another one");
  command->footer("Example:\n  aurasim-lab experiment speed-errors --out out");
  command->callback([out, results, &action] { action = [out, results] { return store_speed(*out, *results); }; });
}

}  // namespace aurasim::lab::commands
