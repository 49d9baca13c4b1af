// A program that is run to its end: it is given bytes, and what it prints is taken.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::cli {

struct ChildProgram {
  std::vector<std::string> words;  ///< the program's path and its arguments
  std::chrono::milliseconds limit{10'000};
  std::size_t most_output = 0;  ///< bytes; a child that prints more is ended
  std::size_t most_memory = 0;  ///< bytes of its address space
};

struct ChildResult {
  std::string output;
  int exit_code = 0;
  int signal = 0;          ///< that ended it; 0: it has ended by itself
  bool timed_out = false;  ///< and was ended
};

/// Waits until it has ended, at most as long as its limit. It runs below our priority and dumps no core. Throws
/// std::runtime_error when no process can be started. Any thread.
ChildResult run_child(const ChildProgram& program, std::string_view input);

}  // namespace aurasim::cli
