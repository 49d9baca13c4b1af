// Notices that exchanges of coupled regions take longer than `exchange_limit` for some time. Uses no DDS: time is
// passed in.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ids.h"

namespace aurasim::process {

class ExchangeWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// To be called after each state with the durations of its exchanges, s, and the region that was waited for longest.
  /// Returns a message for users when half of all exchanges have been longer than `limit_s` for some seconds; only
  /// once.
  std::optional<std::string> note(std::span<const double> seconds, core::RegionId waited_for, double waited_s,
                                  double limit_s, Clock::time_point now);

 private:
  std::optional<std::string> end_window(double limit_s);

  std::optional<Clock::time_point> window_began_;
  std::vector<double> seconds_;                ///< in this window
  std::map<core::RegionId, double> waited_s_;  ///< in this window
  int slow_windows_ = 0;                       ///< one after the other, up to now
  bool has_said_ = false;
};

}  // namespace aurasim::process
