// A run that a client has launched: its launcher's process, `aurasim launch`.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

namespace aurasim::cli::agent {

class LaunchedRun {
 public:
  /// `words`: what follows `aurasim launch`. It ends when this process does. Throws std::runtime_error.
  explicit LaunchedRun(const std::vector<std::string>& words);
  /// Kills it; its nodes end when they see that.
  ~LaunchedRun();
  LaunchedRun(const LaunchedRun&) = delete;
  LaunchedRun& operator=(const LaunchedRun&) = delete;

  bool is_running();
  /// 0: it does not run any more.
  pid_t pid() const { return pid_; }
  /// 128 + a signal that has ended it. Once it does not run any more.
  int exit_code() const { return exit_code_; }
  /// All nodes stop in one state and write their reports; after the deadline it is killed. Returns its exit code.
  int stop(std::chrono::steady_clock::time_point deadline);
  /// Likewise, without waiting for it.
  void ask_to_stop();

 private:
  pid_t pid_ = 0;
  int exit_code_ = 0;
};

/// The end of what was said on standard error, where that is a file.
std::string last_words();

}  // namespace aurasim::cli::agent
