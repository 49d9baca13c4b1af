// The commands of the program aurasim.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_line.h"

namespace aurasim::cli {

/// Every command with its options; parsing it sets `action`, which outlives it.
std::unique_ptr<CLI::App> make_program(Action& action);

/// What to type instead, if `words` (without the program's own name) begin with a command that another program has now;
/// otherwise nothing.
std::optional<std::string> moved_command(const std::vector<std::string>& words);

}  // namespace aurasim::cli
