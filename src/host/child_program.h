// Runs a program to its end with bytes as input, and collects its output.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::host {

struct ChildProgram {
  std::vector<std::string> words;  ///< the program's path and its arguments
  std::chrono::milliseconds limit{10'000};
  std::size_t most_output = 0;  ///< bytes; a child that prints more is ended
  std::size_t most_memory = 0;  ///< bytes of its address space
};

struct ChildResult {
  std::string output;
  int exit_code = 0;
  int signal = 0;          ///< signal that ended the child; 0: it has ended by itself
  bool timed_out = false;  ///< the child was ended because its time was over
};

/// Runs the program and waits until it has ended, at most as long as its limit. The child has a lower priority than
/// this process and dumps no core. Throws std::runtime_error when no process can be started. May be called from any
/// thread.
ChildResult run_child(const ChildProgram& program, std::string_view input);

}  // namespace aurasim::host
