#include <cmath>
#include <memory>

#include "cli/commands.h"
#include "cli/launcher.h"
#include "cli/leave.h"

namespace aurasim::cli {
namespace {

struct Arguments {
  LaunchOptions options;
  core::Step steps = -1;
  double duration_s = -1;
  std::string report;
};

int run_launch(Arguments arguments) {
  const config::Launch launch = config::read_launch(arguments.options.files.file, arguments.options.files.overrides);
  if (arguments.steps >= 0) arguments.options.steps = arguments.steps;
  if (arguments.duration_s >= 0) arguments.options.steps = std::llround(arguments.duration_s * launch.time.step_hz);
  if (!arguments.report.empty()) arguments.options.report = arguments.report;
  Launcher launcher(launch, arguments.options);
  leave(static_cast<int>(launcher.run()));
}

}  // namespace

void add_launch(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("launch", "run every region of a launch file on this host");
  const auto arguments = std::make_shared<Arguments>();
  arguments->options.files.add_to(*command);
  CLI::Option* steps = command->add_option("--steps", arguments->steps, "stop after this state")
                           ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 40));
  command->add_option("--duration", arguments->duration_s, "stop after so many simulated seconds")
      ->check(CLI::Range(0.0, 1e9))
      ->excludes(steps);
  command->add_flag("--headless", arguments->options.headless, "no table, no viewer");
  command->add_option("--record", arguments->options.recording, "file for what the viewer sees; starts it in any case");
  command->add_option("--report", arguments->report, "folder for what the nodes record");
  command->add_option("--start-time-out", arguments->options.start_time_out_s, "seconds to wait for all regions")
      ->check(CLI::Range(1, 3600));
  command->callback([arguments, &action] { action = [arguments] { return run_launch(*arguments); }; });
}

}  // namespace aurasim::cli
