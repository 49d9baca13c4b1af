// aurasim: the one program. See README.md for what to type.
#include <cstdio>
#include <memory>

#include "cli/program.h"
#include "command_line/exit_code.h"

using namespace aurasim;

int main(int argc, char** argv) {
  if (const auto moved = cli::moved_command({argv + 1, argv + argc})) {
    std::fprintf(stderr, "%s\n", moved->c_str());
    return static_cast<int>(command_line::ExitCode::kBadConfig);
  }
  command_line::Action action;
  const std::unique_ptr<CLI::App> program = cli::make_program(action);
  return command_line::run_program(*program, action, argc, argv);
}
