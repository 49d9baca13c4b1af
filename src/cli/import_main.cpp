// aurasim-import: `aurasim import` and `aurasim export` become it (cli/import_arguments.h).
#include <cstdio>

#include <CLI/CLI.hpp>

#include "cli/import_program.h"
#include "command_line/exit_code.h"
#include "config/launch.h"

using namespace aurasim;

int main(int argc, char** argv) {
  command_line::Action action;
  const std::unique_ptr<CLI::App> program = cli::make_import_program(action);
  try {
    program->parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return program->exit(error) == 0 ? 0 : static_cast<int>(command_line::ExitCode::kBadConfig);
  } catch (const config::BadConfig& error) {
    for (const std::string& line : error.errors()) std::fprintf(stderr, "%s\n", line.c_str());
    return static_cast<int>(command_line::ExitCode::kBadConfig);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(command_line::ExitCode::kFailed);
  }
}
