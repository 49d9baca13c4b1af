#include "command_line/leave.h"

#include <cstdio>
#include <cstdlib>
#include <exception>

#include <spdlog/spdlog.h>

#include "config/launch.h"

namespace aurasim::command_line {

void leave(int exit_code) {
  spdlog::default_logger()->flush();
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

void leave_after(const std::function<ExitCode()>& work) {
  ExitCode code = ExitCode::kFailed;
  try {
    code = work();
  } catch (const config::BadConfig& error) {
    for (const std::string& line : error.errors()) std::fprintf(stderr, "%s\n", line.c_str());
    code = ExitCode::kBadConfig;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  leave(static_cast<int>(code));
}

}  // namespace aurasim::command_line
