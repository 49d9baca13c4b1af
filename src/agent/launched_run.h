// A run that a client has launched: its launcher's process, `aurasim launch`.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

namespace aurasim::agent {

class LaunchedRun {
 public:
  /// `words`: arguments of `aurasim launch`. The launcher ends when this process does. Throws std::runtime_error.
  explicit LaunchedRun(const std::vector<std::string>& words);
  /// Kills the launcher. Its nodes end when they notice.
  ~LaunchedRun();
  LaunchedRun(const LaunchedRun&) = delete;
  LaunchedRun& operator=(const LaunchedRun&) = delete;

  bool is_running();
  /// Process id; 0 once it has ended.
  pid_t pid() const { return pid_; }
  /// Exit code, or 128 + the signal that ended it. Precondition: it has ended.
  int exit_code() const { return exit_code_; }
  /// Stops the run: all nodes stop in one state and write their reports. After the deadline the launcher is killed.
  /// Returns its exit code.
  int stop(std::chrono::steady_clock::time_point deadline);
  /// As stop(), without waiting for the end.
  void ask_to_stop();

 private:
  pid_t pid_ = 0;
  int exit_code_ = 0;
};

/// The last lines of standard error, if that is a file.
std::string last_words();

}  // namespace aurasim::agent
