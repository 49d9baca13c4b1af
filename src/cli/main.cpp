// aurasim: the one program. See README.md for what to type.
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "cli/exit_code.h"
#include "config/launch.h"

using namespace aurasim;

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("aurasim"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  CLI::App program("One world of rigid bodies, simulated by any number of nodes.", "aurasim");
  program.require_subcommand(1);
  cli::Action action;
  cli::add_check(program, action);
  cli::add_keys(program, action);
  cli::add_node(program, action);
  cli::add_launch(program, action);
  cli::add_top(program, action);
  cli::add_echo(program, action);
  cli::add_send(program, action);
  cli::add_overseer(program, action);
  cli::add_replay(program, action);
  cli::add_report(program, action);
  cli::add_compare(program, action);
  cli::add_experiment(program, action);
  try {
    program.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : static_cast<int>(cli::ExitCode::kBadConfig);
  } catch (const config::BadConfig& error) {
    for (const std::string& line : error.errors()) std::fprintf(stderr, "%s\n", line.c_str());
    return static_cast<int>(cli::ExitCode::kBadConfig);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return static_cast<int>(cli::ExitCode::kFailed);
  }
}
