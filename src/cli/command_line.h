// What the command lines of all our programs have in common, whichever commands a program has: how a command is chosen
// and run, the launch file as an argument, and what is said to words that make no sense.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace aurasim::cli {

/// Set by the command that was chosen; run after parsing.
using Action = std::function<int()>;

/// The launch file and its overrides, as every command takes them.
struct FileArguments {
  std::string file;
  std::vector<std::string> overrides;

  void add_to(CLI::App& command);
};

/// Hides the defaults that stand for "not given", which CLI11 captures as well. To be called with all commands added.
void hide_empty_defaults(CLI::App& app);

/// Parses the command line and runs the command that it chooses. Errors go to standard error, with the nearest word for
/// a mistyped one. Returns the exit code.
int run_program(CLI::App& program, const Action& action, int argc, char** argv);

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
