// Decides how the launcher ends a node that it has asked to stop. As long as the node makes progress it is not
// interrupted, because its report would be lost.
#pragma once

#include <chrono>
#include <cstddef>

#include "dds/control.h"
#include "messages/status_period.h"

namespace aurasim::process {

enum class Urge { kNone, kTerminate, kKill };

class NodeEnding {
 public:
  using Clock = std::chrono::steady_clock;

  /// `regions`: number of the run's, because nodes of many publish their states less often.
  explicit NodeEnding(Clock::time_point stop_requested, std::size_t regions = 1)
      : begin_(stop_requested), standstill_(kStandstill * messages::status_period(regions)), moved_(stop_requested) {}

  /// The signal to send now to a process that still runs. `seen`: status of its node; null if there is none. kTerminate
  /// is returned once.
  Urge urge(Clock::time_point now, const messages::SeenStatus* seen);

 private:
  bool is_stuck(Clock::time_point now, const messages::SeenStatus* seen);
  bool is_given_up(Clock::time_point now, const messages::SeenStatus* seen) const;

  static constexpr int kStandstill = 5;  ///< number of statuses in which the step does not grow

  Clock::time_point begin_;
  Clock::duration standstill_;
  Clock::time_point moved_;  ///< when its step was seen to grow
  core::Step step_ = 0;
  bool terminated_ = false;
};

}  // namespace aurasim::process
