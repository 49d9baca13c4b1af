#include "command_line/command_line.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "command_line/exit_code.h"
#include "command_line/nearest_word.h"
#include "config/launch.h"
#include "config/shipped_files.h"

namespace aurasim::command_line {
namespace {

std::vector<std::string> typed_names(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> typed_names(const std::vector<const CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) {
    if (!option->get_positional()) names.push_back(name_of(*option));
  }
  return names;
}

std::string path_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : path_of(*app.get_parent()) + " " + app.get_name();
}

std::string complaint(const CLI::App& app, const char* what, const std::string& word,
                      const std::vector<std::string>& known) {
  const std::string where = path_of(app);
  const std::optional<std::string> nearest = nearest_word(word.substr(0, word.find('=')), known);
  if (nearest) return fmt::format("{}: no {} '{}'; did you mean '{}'?", where, what, word, *nearest);
  return fmt::format("{}: no {} '{}'; there are {}", where, what, word, fmt::join(known, ", "));
}

bool has_option(const CLI::App& app, const std::string& word) {
  return app.get_option_no_throw(word.substr(0, word.find('='))) != nullptr;
}

/// Negative numbers are values, not options.
bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word != "--" && word.find_first_of("0123456789.") != 1;
}

}  // namespace

void FileArguments::add_to(CLI::App& command) {
  command.add_option("FILE", file, "launch file, or the name of one that comes with the program: demo, tower, ...")
      ->required()
      ->transform(config::launch_file_named);
  command.add_option("--set", overrides, "change one key of the launch file: key.path=value")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void hide_empty_defaults(CLI::App& app) {
  for (CLI::Option* option : app.get_options([](CLI::Option*) { return true; })) {
    const std::string& text = option->get_default_str();
    if (text == "[]" || text == "\"\"" || text == "-1" || text == "1e+09") option->default_str("");
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) hide_empty_defaults(*command);
}

int run_program(CLI::App& program, const Action& action, int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(program.get_name()));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  try {
    program.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help and --version
    if (const auto unknown = unknown_word(program, {argv + 1, argv + argc})) {
      std::fprintf(stderr, "%s\n", unknown->c_str());
    } else {
      program.exit(error);
    }
    return static_cast<int>(ExitCode::kBadConfig);
  } catch (const config::BadConfig& error) {
    for (const std::string& line : error.errors()) std::fprintf(stderr, "%s\n", line.c_str());
    return static_cast<int>(ExitCode::kBadConfig);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return static_cast<int>(ExitCode::kFailed);
  }
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

std::string name_of(const CLI::Option& option) {
  if (!option.get_lnames().empty()) return "--" + option.get_lnames().front();
  if (!option.get_snames().empty()) return "-" + option.get_snames().front();
  return option.get_name(true);
}

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // TEXT:{one,two}
  const std::size_t begin = type.find(":{");
  if (begin == std::string::npos || type.back() != '}') return {};
  std::istringstream in(type.substr(begin + 2, type.size() - begin - 3));
  std::vector<std::string> choices;
  for (std::string choice; std::getline(in, choice, ',');) choices.push_back(choice);
  return choices;
}

std::optional<std::string> unknown_word(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* app = &program;
  for (const std::string& word : words) {
    if (word == "--") return std::nullopt;
    if (is_option(word)) {
      if (!has_option(*app, word)) return complaint(*app, "option", word, typed_names(options_of(*app)));
      continue;
    }
    const std::vector<const CLI::App*> named =
        app->get_subcommands([&word](const CLI::App* command) { return command->check_name(word); });
    const CLI::App* below = named.empty() ? nullptr : named.front();
    if (below == nullptr && !commands_of(*app).empty()) {
      return complaint(*app, "command", word, typed_names(commands_of(*app)));
    }
    if (below != nullptr) app = below;
  }
  return std::nullopt;
}

}  // namespace aurasim::command_line
