// aurasim-lab: the laboratory. docs/development.md has what to type.
#include <memory>

#include "lab/commands/program.h"

using namespace aurasim;

int main(int argc, char** argv) {
  command_line::Action action;
  const std::unique_ptr<CLI::App> program = lab::commands::make_program(action);
  return command_line::run_program(*program, action, argc, argv);
}
