#include "cli/program.h"

#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "command_line/completion.h"
#include "command_line/manual.h"
#include "host/version.h"

namespace aurasim::cli {
namespace {

/// Commands that this program had once, and the program that has them now.
constexpr std::array<std::pair<std::string_view, std::string_view>, 1> kMovedCommands = {
    {{"experiment", "aurasim-lab"}}};

}  // namespace

std::unique_ptr<CLI::App> make_program(command_line::Action& action) {
  auto program = std::make_unique<CLI::App>("One world of rigid bodies, simulated by any number of nodes.", "aurasim");
  program->option_defaults()->always_capture_default();
  program->set_version_flag("--version", host::version_text, "what this program was made from");
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
  add_hub(*program, action);
  add_top(*program, action);
  add_echo(*program, action);
  add_cut(*program, action);
  add_send(*program, action);
  add_overseer(*program, action);
  add_replay(*program, action);
  add_report(*program, action);
  add_compare(*program, action);
  add_mesh_loader(*program, action);
  add_agent(*program, action);
  command_line::add_completion(*program, action);
  command_line::add_manual(
      *program, action,
      "Each node owns one region of the world and runs Bullet for the bodies in it; nodes find each other and talk "
      "over DDS, and hand bodies over before two of them can touch across a border.");
  command_line::hide_empty_defaults(*program);
  return program;
}

std::optional<std::string> moved_command(const std::vector<std::string>& words) {
  if (words.empty()) return std::nullopt;
  for (const auto& [command, program] : kMovedCommands) {
    if (words.front() != command) continue;
    return fmt::format(
        "aurasim: '{}' is a command of the program {} now: {} {}\n"
        "From the sources, `scripts/build.sh release {}` builds it as build/release/{}",
        command, program, program, fmt::join(words, " "), program, program);
  }
  return std::nullopt;
}

}  // namespace aurasim::cli
