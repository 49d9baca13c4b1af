#include <memory>

#include "cli/commands.h"
#include "cli/launcher.h"
#include "cli/leave.h"
#include "cli/run_length.h"

namespace aurasim::cli {
namespace {

struct Arguments {
  LaunchOptions options;
  RunLength length;
  std::string report;
};

int run_launch(Arguments arguments) {
  const config::Launch launch = config::read_launch(arguments.options.files.file, arguments.options.files.overrides);
  arguments.options.steps = arguments.length.last_step(launch);
  if (!arguments.report.empty()) arguments.options.report = arguments.report;
  Launcher launcher(launch, arguments.options);
  leave_after([&launcher] { return launcher.run(); });
}

}  // namespace

void add_launch(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("launch", "run every region of a launch file on this host");
  const auto arguments = std::make_shared<Arguments>();
  arguments->options.files.add_to(*command);
  arguments->length.add_to(*command);
  command->add_flag("--headless", arguments->options.headless, "no table, no viewer");
  command->add_option("--record", arguments->options.recording, "file for what the viewer sees; starts it in any case");
  command->add_option("--report", arguments->report, "folder for what the nodes record");
  command->add_option("--start-time-out", arguments->options.start_time_out_s, "seconds to wait for all regions")
      ->check(CLI::Range(1, 3600));
  command->callback([arguments, &action] { action = [arguments] { return run_launch(*arguments); }; });
}

}  // namespace aurasim::cli
