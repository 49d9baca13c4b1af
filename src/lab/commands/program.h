// The commands of the program aurasim-lab.
#pragma once

#include <memory>

#include "cli/command_line.h"

namespace aurasim::lab::commands {

/// Every command with its options. Parsing sets `action`, which must outlive the result.
std::unique_ptr<CLI::App> make_program(cli::Action& action);

}  // namespace aurasim::lab::commands
