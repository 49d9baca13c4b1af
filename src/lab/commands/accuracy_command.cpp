// `aurasim-lab experiment stability` and `pareto`.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "host/stop_signal.h"
#include "lab/commands/commands.h"
#include "lab/commands/progress_bar.h"
#include "lab/commands/target_list.h"
#include "lab/pareto.h"
#include "lab/stability/stability.h"

namespace aurasim::lab::commands {
namespace {

/// Shows the progress of an experiment, and returns false when the user wants to stop.
class Watch {
 public:
  bool operator()(double share) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    bar_.show({share, elapsed_s, share > 0 ? elapsed_s * (1 - share) / share : 0});
    return !host::stop_requested();
  }
  int end(const std::vector<lab::Target>& targets) const {
    bar_.end();
    print(targets);
    return static_cast<int>(all_met(targets) && !host::stop_requested() ? command_line::ExitCode::kOk
                                                                        : command_line::ExitCode::kFailed);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  ProgressBar bar_;
};

/// Error if there is no such case; empty otherwise. Cases are not listed in advance, because every command would wait
/// for that.
std::string problem_with_case(const std::string& name) {
  std::vector<std::string> names;
  for (const lab::Case& c : lab::stability_cases()) names.push_back(c.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  return fmt::format("no case '{}'; there are {}", name, fmt::join(names, ", "));
}

int run_stability(const lab::StabilityPlan& plan, const std::string& out) {
  host::catch_stop_signals();
  Watch watch;
  const auto rows = lab::run_stability(plan, [&](double share, const std::string&) { return watch(share); });
  return watch.end(lab::write_stability(rows, out));
}

int run_pareto(const lab::ParetoPlan& plan, const std::string& out) {
  host::catch_stop_signals();
  Watch watch;
  const auto points = lab::run_pareto(plan, [&](double share) { return watch(share); });
  return watch.end(lab::write_pareto(points, plan, out));
}

}  // namespace

void add_stability(CLI::App& experiments, command_line::Action& action) {
  CLI::App* command = experiments.add_subcommand("stability", "hard cases against closed forms, also on a border");
  const auto plan = std::make_shared<lab::StabilityPlan>();
  const auto out = std::make_shared<std::string>();
  command->add_option("--out", *out, "folder for the results")->required();
  command->add_option("--cases", plan->cases, "only these")->delimiter(',')->check(problem_with_case);
  command->add_option("--step-hz", plan->step_hz, "steps per second")->delimiter(',')->check(CLI::Range(1, 10000));
  command->add_flag("--presets,!--no-presets", plan->presets, "also with every preset");
  command->add_option("--longest", plan->longest_s, "cut every case to this many simulated seconds");
  command->add_option("--standing", plan->standing_s, "seconds that piles have to stand with the preset balanced");
  command->footer("Example:\n  aurasim-lab experiment stability --cases stack_20 --out out");
  command->callback([plan, out, &action] { action = [plan, out] { return run_stability(*plan, *out); }; });
}

void add_pareto(CLI::App& experiments, command_line::Action& action) {
  CLI::App* command =
      experiments.add_subcommand("pareto", "error against CPU time: solver, iterations, substeps, nodes");
  const auto plan = std::make_shared<lab::ParetoPlan>();
  const auto out = std::make_shared<std::string>();
  command->add_option("--out", *out, "folder for the results")->required();
  command->add_option("--simulated", plan->simulated_s, "seconds of each case")->check(CLI::Range(0.1, 1000.0));
  command->add_option("--iterations", plan->iterations, "of the solver")->delimiter(',')->check(CLI::Range(1, 1000));
  command->add_option("--substeps", plan->substeps, "of a step")->delimiter(',')->check(CLI::Range(1, 64));
  command->add_flag("--nodes,!--no-nodes", plan->nodes, "also vary the number of nodes, sync mode, lookahead and aura");
  command->footer("Example:\n  aurasim-lab experiment pareto --no-nodes --out out");
  command->callback([plan, out, &action] { action = [plan, out] { return run_pareto(*plan, *out); }; });
}

}  // namespace aurasim::lab::commands
