// aurasim: the one program. See README.md for what to type.
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/exit_code.h"
#include "cli/program.h"
#include "config/launch.h"

using namespace aurasim;

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("aurasim"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  cli::Action action;
  const std::unique_ptr<CLI::App> program = cli::make_program(action);
  try {
    program->parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program->exit(error);  // --help and --version
    if (const auto unknown = cli::unknown_word(*program, {argv + 1, argv + argc})) {
      std::fprintf(stderr, "%s\n", unknown->c_str());
    } else {
      program->exit(error);
    }
    return static_cast<int>(cli::ExitCode::kBadConfig);
  } catch (const config::BadConfig& error) {
    for (const std::string& line : error.errors()) std::fprintf(stderr, "%s\n", line.c_str());
    return static_cast<int>(cli::ExitCode::kBadConfig);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return static_cast<int>(cli::ExitCode::kFailed);
  }
}
