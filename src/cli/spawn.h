// Starting another program.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace aurasim::cli {

/// `words`: the program's path and its arguments. It does not get our Ctrl-C, and ends (SIGTERM) when the calling
/// thread does. Exit code 127 if there is no such program. Throws std::runtime_error when no process can be started.
pid_t spawn(std::vector<std::string> words);

}  // namespace aurasim::cli
