// Shared parts of the command lines of all our programs: how a command is chosen and run, the launch file as an
// argument, and the error for an unknown word.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace aurasim::command_line {

/// The command to run. The chosen subcommand sets it during parsing.
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

/// Commands below `app`, and its options, as shown to users in the order of --help.
std::vector<const CLI::App*> commands_of(const CLI::App& app);
std::vector<const CLI::Option*> options_of(const CLI::App& app);
/// Its long name, or its short one, as it is typed; FILE and the like for what has none.
std::string name_of(const CLI::Option& option);
/// The words that it takes; empty when it takes others as well.
std::vector<std::string> choices_of(const CLI::Option& option);

/// Message about the first word that is neither a command nor an option at its place, with the nearest valid word.
/// Nothing if there is no such word. `words`: the command line without the program's name.
std::optional<std::string> unknown_word(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace aurasim::command_line
