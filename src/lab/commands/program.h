// The commands of the program aurasim-lab.
#pragma once

#include <memory>

#include "command_line/command_line.h"

namespace aurasim::lab::commands {

/// Every command with its options. Parsing sets `action`, which must outlive the result.
std::unique_ptr<CLI::App> make_program(command_line::Action& action);

}  // namespace aurasim::lab::commands
