// Decides how the launcher ends a node that it has asked to stop. As long as the node makes progress it is not
// interrupted, because its report would be lost.
#pragma once

#include <chrono>

#include "dds/control.h"

namespace aurasim::process {

enum class Urge { kNone, kTerminate, kKill };

class NodeEnding {
 public:
  using Clock = std::chrono::steady_clock;

  explicit NodeEnding(Clock::time_point stop_requested) : begin_(stop_requested), moved_(stop_requested) {}

  /// The signal to send now to a process that still runs. `seen`: status of its node; null if there is none. kTerminate
  /// is returned once.
  Urge urge(Clock::time_point now, const messages::SeenStatus* seen);

 private:
  bool is_stuck(Clock::time_point now, const messages::SeenStatus* seen);
  bool is_given_up(Clock::time_point now, const messages::SeenStatus* seen) const;

  Clock::time_point begin_;
  Clock::time_point moved_;  ///< when its step was seen to grow
  core::Step step_ = 0;
  bool terminated_ = false;
};

}  // namespace aurasim::process
