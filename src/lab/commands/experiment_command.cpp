#include "lab/commands/commands.h"

namespace aurasim::lab::commands {

void add_experiment(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("experiment", "random worlds, long runs, and the speed of a step");
  command->require_subcommand(1);
  command->footer("Example:\n  aurasim-lab experiment scenes --seeds 1-200 --out out");
  add_scenes(*command, action);
  add_endurance(*command, action);
  add_speed(*command, action);
  add_speed_errors(*command, action);
}

}  // namespace aurasim::lab::commands
