// Starting another program.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

namespace aurasim::cli {

/// `words`: the program's path and its arguments. It does not get our Ctrl-C, and ends (SIGTERM) when the calling
/// thread does. What it prints goes to the file descriptor `output`. Exit code 127 if there is no such program. Throws
/// std::runtime_error when no process can be started.
pid_t spawn(std::vector<std::string> words, int output = STDOUT_FILENO);

/// Likewise, but for good: it has a session of its own, and ends neither with us nor with our terminal. Throws
/// likewise.
void spawn_apart(std::vector<std::string> words);

/// The words that this process was started with.
std::vector<std::string> own_command_line();
/// This process becomes the program `words[0]` with these arguments, which has no file or socket of ours but the
/// standard ones and the heartbeat's pipe. Throws std::runtime_error if that fails.
[[noreturn]] void become(std::vector<std::string> words);

}  // namespace aurasim::cli
