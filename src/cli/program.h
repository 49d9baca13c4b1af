// The commands of the program aurasim.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/command_line.h"

namespace aurasim::cli {

/// Every command with its options. Parsing sets `action`, which must outlive the result.
std::unique_ptr<CLI::App> make_program(command_line::Action& action);

/// The command to type instead, if `words` (without the program's name) begin with a command that has moved to another
/// program. Otherwise nothing.
std::optional<std::string> moved_command(const std::vector<std::string>& words);

}  // namespace aurasim::cli
