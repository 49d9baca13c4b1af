// Starting another program.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

namespace aurasim::host {

/// `words`: the program's path and its arguments. The program does not receive this terminal's Ctrl-C, and gets SIGTERM
/// when the calling thread ends. Its output goes to the file descriptor `output`. Exit code 127 if there is no such
/// program. Throws std::runtime_error when no process can be started.
pid_t spawn(std::vector<std::string> words, int output = STDOUT_FILENO);

/// As spawn(), but the program has a session of its own, and ends neither with this process nor with its terminal.
void spawn_apart(std::vector<std::string> words);

/// The command line that this process was started with.
std::vector<std::string> own_command_line();
/// Replaces this process by the program `words[0]` with these arguments. Open files and sockets are closed, except the
/// standard ones and the heartbeat's pipe. Throws std::runtime_error if that fails.
[[noreturn]] void become(std::vector<std::string> words);

}  // namespace aurasim::host
