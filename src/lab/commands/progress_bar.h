// Shows how far a long piece of work is, and how long it may still take.
#pragma once

#include <chrono>

namespace aurasim::lab::commands {

/// Writes to standard error. A terminal gets one line that is written over; files and pipes get one line for every
/// tenth. The work begins when the bar is made.
class ProgressBar {
 public:
  ProgressBar();
  /// Ends the line on a terminal.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows the share that is done. False if the user wants to stop.
  bool operator()(double share);

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  bool is_terminal_;
  int last_tenth_ = -1;
};

}  // namespace aurasim::lab::commands
