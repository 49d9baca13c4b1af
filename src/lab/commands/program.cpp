#include "lab/commands/program.h"

#include "command_line/completion.h"
#include "command_line/manual.h"
#include "host/version.h"
#include "lab/commands/commands.h"

namespace aurasim::lab::commands {

std::unique_ptr<CLI::App> make_program(command_line::Action& action) {
  auto program =
      std::make_unique<CLI::App>("The laboratory of aurasim: experiments, and random worlds.", "aurasim-lab");
  program->option_defaults()->always_capture_default();
  program->set_version_flag("--version", host::version_text, "what this program was made from");
  program->require_subcommand(1);
  program->footer(
      "`aurasim-lab experiment COMMAND --help` has the options of an experiment. Example:\n"
      "  aurasim-lab experiment scenes --seeds 1-200 --out out");
  add_experiment(*program, action);
  add_run(*program, action);
  command_line::add_completion(*program, action);
  command_line::add_manual(
      *program, action,
      "It measures the program aurasim: the thesis's experiments, hard cases against closed forms, speed, "
      "scalability, and random worlds on several nodes and on one. Nothing of it is in the program aurasim.");
  command_line::hide_empty_defaults(*program);
  return program;
}

}  // namespace aurasim::lab::commands
