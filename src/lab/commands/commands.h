// One function per command of the laboratory. Each adds itself to `aurasim-lab experiment`, but for `run`.
#pragma once

#include "command_line/command_line.h"

namespace aurasim::lab::commands {

/// The command `experiment` itself, with all that are below it.
void add_experiment(CLI::App& program, command_line::Action& action);

/// The command `run SUITE`, beside `experiment`.
void add_run(CLI::App& program, command_line::Action& action);

void add_scenes(CLI::App& experiment, command_line::Action& action);
void add_endurance(CLI::App& experiment, command_line::Action& action);
void add_speed(CLI::App& experiment, command_line::Action& action);
void add_speed_errors(CLI::App& experiment, command_line::Action& action);

}  // namespace aurasim::lab::commands
