// Completion of the command line in shells, made from the commands themselves.
#pragma once

#include <string>

#include "command_line/command_line.h"

namespace aurasim::command_line {

/// Completion scripts for bash and zsh.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);

/// The command `completion`, which prints such a script.
void add_completion(CLI::App& program, Action& action);

}  // namespace aurasim::command_line
