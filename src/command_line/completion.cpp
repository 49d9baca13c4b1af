#include "command_line/completion.h"

#include <algorithm>
#include <functional>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command_line/command_line.h"

namespace aurasim::command_line {
namespace {

/// Calls `visit(app, "aurasim send spawn")` for the program and everything below it.
template <class Visit>
void for_each_command(const CLI::App& app, const std::string& path, const Visit& visit) {
  visit(app, path);
  for (const CLI::App* command : commands_of(app)) for_each_command(*command, path + " " + command->get_name(), visit);
}

/// The branches of a `case` that find out which command is being typed, and which values an option takes.
std::string path_cases(const CLI::App& program) {
  std::string text;
  for_each_command(program, program.get_name(), [&](const CLI::App& app, const std::string& path) {
    for (const CLI::App* command : commands_of(app))
      text += fmt::format("      '{} {}') ;;\n", path, command->get_name());
  });
  return text;
}

std::string value_cases(const CLI::App& program, const char* add) {
  std::string text;
  for_each_command(program, program.get_name(), [&](const CLI::App& app, const std::string& path) {
    for (const CLI::Option* option : options_of(app)) {
      const std::vector<std::string> choices = choices_of(*option);
      if (choices.empty() || option->get_positional()) continue;
      text += fmt::format("    '{} {}') {} ;;\n", path, name_of(*option),
                          fmt::format(fmt::runtime(add), fmt::join(choices, " ")));
    }
  });
  return text;
}

/// Commands, options, and what a positional argument may be.
std::vector<std::pair<std::string, std::string>> words_of(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const CLI::App* command : commands_of(app)) words.emplace_back(command->get_name(), command->get_description());
  for (const CLI::Option* option : options_of(app)) {
    if (!option->get_positional()) words.emplace_back(name_of(*option), option->get_description());
    if (!option->get_positional()) continue;
    for (const std::string& choice : choices_of(*option)) words.emplace_back(choice, option->get_description());
  }
  return words;
}

/// For a word in single quotes before a colon and a description.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') out += "'\\'";
    if (c == ':') out += '\\';
    out += c;
  }
  return out;
}

constexpr const char* kBash = R"(# Completion of {program} for bash, made by `{program} completion bash`.
{function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} last=${{COMP_WORDS[COMP_CWORD-1]}} command={program} word words=
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$command $word" in
{paths}      *) continue ;;
    esac
    command+=" $word"
  done
  case "$command $last" in
{values}    *)
      case "$command" in
{words}      esac ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F {function} {program}
)";

constexpr const char* kZsh = R"(#compdef {program}
# Completion of {program} for zsh, made by `{program} completion zsh`.
{function}() {{
  local command={program} word
  local -a candidates
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    case "$command $word" in
{paths}      *) continue ;;
    esac
    command+=" $word"
  done
  case "$command ${{words[CURRENT-1]}}" in
{values}  esac
  case "$command" in
{words}  esac
  _describe -o '{program}' candidates
  _files
}}
{function} "$@"
)";

/// Name of the shell function: "_aurasim_lab" for aurasim-lab.
std::string function_for(const CLI::App& program) {
  std::string name = "_" + program.get_name();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string filled_in(const char* script, const CLI::App& program, const char* add_values, const std::string& words) {
  return fmt::format(fmt::runtime(script), fmt::arg("program", program.get_name()),
                     fmt::arg("function", function_for(program)), fmt::arg("paths", path_cases(program)),
                     fmt::arg("values", value_cases(program, add_values)), fmt::arg("words", words));
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  std::string words;
  for_each_command(program, program.get_name(), [&](const CLI::App& app, const std::string& path) {
    std::vector<std::string> names;
    for (const auto& [word, about] : words_of(app)) names.push_back(word);
    words += fmt::format("        '{}') words='{}' ;;\n", path, fmt::join(names, " "));
  });
  return filled_in(kBash, program, "words='{}'", words);
}

std::string zsh_completion(const CLI::App& program) {
  std::string words;
  for_each_command(program, program.get_name(), [&](const CLI::App& app, const std::string& path) {
    words += fmt::format("    '{}') candidates=(\n", path);
    for (const auto& [word, about] : words_of(app))
      words += fmt::format("      '{}:{}'\n", quoted(word), quoted(about));
    words += "    ) ;;\n";
  });
  return filled_in(kZsh, program, "compadd -- {}; return", words);
}

void add_completion(CLI::App& program, Action& action) {
  const std::string name = program.get_name();
  CLI::App* command = program.add_subcommand("completion", "print what a shell completes " + name + "'s commands with");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "whose")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(fmt::format("Example:\n  source <({} completion bash)", name));
  command->callback([shell, &program, &action] {
    action = [shell, &program] {
      fmt::print("{}", *shell == "bash" ? bash_completion(program) : zsh_completion(program));
      return 0;
    };
  });
}

}  // namespace aurasim::command_line
