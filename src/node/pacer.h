// When each step is due. All nodes share one epoch, so their steps are phase-aligned.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/ids.h"

namespace aurasim::node {

using WallClock = std::chrono::system_clock;

class Pacer {
 public:
  /// `wait` false: every step is due at once.
  Pacer(double step_s, bool wait) : step_s_(step_s), wait_(wait) {}

  /// Step `first` is due at `epoch_ns` (wall clock, nanoseconds since 1970), the others follow.
  void set_epoch(core::Step first, std::int64_t epoch_ns);

  /// From `step` on, so many simulated seconds per second; its own time stays.
  void set_rate(core::Step step, double rate);

  /// Time until `step` is due; 0 when it is.
  std::chrono::nanoseconds until(core::Step step) const;

 private:
  double step_s_;
  bool wait_;
  core::Step first_ = 0;
  std::int64_t epoch_ns_ = 0;
  double rate_ = 1;
  std::int64_t due_ns(core::Step step) const;
};

/// Nanoseconds since 1970.
std::int64_t wall_clock_ns();

}  // namespace aurasim::node
