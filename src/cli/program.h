// The whole command line of the program, and what it says to one that makes no sense.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"

namespace aurasim::cli {

/// Every command with its options; parsing it sets `action`, which outlives it.
std::unique_ptr<CLI::App> make_program(Action& action);

/// Commands below `app`, options of it: those that are shown to people, in the order of --help.
std::vector<const CLI::App*> commands_of(const CLI::App& app);
std::vector<const CLI::Option*> options_of(const CLI::App& app);
/// Its long name, or its short one, as it is typed; FILE and the like for what has none.
std::string name_of(const CLI::Option& option);
/// The words that it takes; empty when it takes others as well.
std::vector<std::string> choices_of(const CLI::Option& option);

/// About the first word that is neither a command nor an option where it stands, with the nearest that is; nothing when
/// there is no such word. `words`: without the program's own name.
std::optional<std::string> unknown_word(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace aurasim::cli
