// How the launcher sees a node off that has been told to stop: as long as it shows that it is on its way, nobody cuts
// it short, or its report would be lost.
#pragma once

#include <chrono>

#include "dds/control.h"

namespace aurasim::cli {

enum class Urge { kNone, kTerminate, kKill };

class NodeEnding {
 public:
  using Clock = std::chrono::steady_clock;

  explicit NodeEnding(Clock::time_point told_to_stop) : begin_(told_to_stop), moved_(told_to_stop) {}

  /// What to do now with a process that still runs. `seen`: what is known of its node; null if nothing is.
  /// kTerminate is given once.
  Urge urge(Clock::time_point now, const dds::SeenStatus* seen);

 private:
  bool is_stuck(Clock::time_point now, const dds::SeenStatus* seen);
  bool is_given_up(Clock::time_point now, const dds::SeenStatus* seen) const;

  Clock::time_point begin_;
  Clock::time_point moved_;  ///< when its step was seen to grow
  core::Step step_ = 0;
  bool terminated_ = false;
};

}  // namespace aurasim::cli
