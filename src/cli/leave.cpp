#include "cli/leave.h"

#include <cstdio>
#include <cstdlib>

#include <spdlog/spdlog.h>

namespace aurasim::cli {

void leave(int exit_code) {
  spdlog::default_logger()->flush();
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

}  // namespace aurasim::cli
