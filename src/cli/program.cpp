#include "cli/program.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/nearest_word.h"
#include "cli/version.h"

namespace aurasim::cli {
namespace {

/// CLI11 also captures the defaults that stand for "not given".
void hide_empty_defaults(CLI::App& app) {
  for (CLI::Option* option : app.get_options([](CLI::Option*) { return true; })) {
    const std::string& text = option->get_default_str();
    if (text == "[]" || text == "\"\"" || text == "-1" || text == "1e+09") option->default_str("");
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) hide_empty_defaults(*command);
}

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

std::unique_ptr<CLI::App> make_program(Action& action) {
  auto program = std::make_unique<CLI::App>("One world of rigid bodies, simulated by any number of nodes.", "aurasim");
  program->option_defaults()->always_capture_default();
  program->set_version_flag("--version", version_text, "what this program was made from");
  program->require_subcommand(1);
  program->footer(
      "`aurasim COMMAND --help` has the options of a command. Examples:\n"
      "  aurasim launch demo              four nodes, a table, and a viewer for the browser\n"
      "  aurasim send pause demo          from another terminal");
  add_check(*program, action);
  add_schema(*program, action);
  add_import(*program, action);
  add_export(*program, action);
  add_keys(*program, action);
  add_node(*program, action);
  add_launch(*program, action);
  add_spare(*program, action);
  add_top(*program, action);
  add_echo(*program, action);
  add_cut(*program, action);
  add_send(*program, action);
  add_overseer(*program, action);
  add_replay(*program, action);
  add_report(*program, action);
  add_compare(*program, action);
  add_experiment(*program, action);
  add_mesh_loader(*program, action);
  add_agent(*program, action);
  add_completion(*program, action);
  add_manual(*program, action);
  hide_empty_defaults(*program);
  return program;
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

}  // namespace aurasim::cli
