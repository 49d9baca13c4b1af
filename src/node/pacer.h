// When each step is due. All nodes share one epoch, so their steps are phase-aligned. The epoch is named by the wall
// clock, which hosts have in common; from then on the steady clock keeps the pace, so that a wall clock that is set
// makes no node run ahead or stand still. Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/ids.h"

namespace aurasim::node {

/// One moment on both clocks.
struct Instant {
  std::chrono::steady_clock::time_point steady;
  std::int64_t wall_ns = 0;  ///< since 1970
};

Instant read_clocks();
/// Nanoseconds since 1970.
std::int64_t wall_clock_ns();

/// Wall clocks that differ by less are held for one: an epoch is believed to the nanosecond, however long it was on its
/// way. By more: it counts from the moment when it came.
inline constexpr std::chrono::milliseconds kClockTolerance{250};

class Pacer {
 public:
  /// `wait` false: every step is due at once.
  Pacer(double step_s, bool wait) : step_s_(step_s), wait_(wait) {}

  /// Step `first` is due at `epoch_ns` (wall clock, nanoseconds since 1970), the others follow. `clock_ahead`: how far
  /// the wall clock of whoever named the epoch is ahead of ours.
  void set_epoch(core::Step first, std::int64_t epoch_ns, std::chrono::nanoseconds clock_ahead, const Instant& now);

  /// Step `step` is due at `epoch_ns`, those after it at so many simulated seconds per second.
  void set_rate(double rate, core::Step step, std::int64_t epoch_ns, std::chrono::nanoseconds clock_ahead,
                const Instant& now);
  double rate() const { return rate_; }

  /// When `step` is due, or was.
  std::chrono::steady_clock::time_point due(core::Step step) const;
  /// Time until `step` is due; 0 when it is.
  std::chrono::nanoseconds until(core::Step step, const Instant& now) const;

 private:
  double step_s_;
  bool wait_;
  core::Step first_ = 0;
  std::chrono::steady_clock::time_point epoch_;
  double rate_ = 1;
};

/// Notices that the wall clock was set.
class ClockWatch {
 public:
  explicit ClockWatch(const Instant& now) : last_(now) {}

  /// How far the wall clock has jumped ahead (or back: negative) since the last look; 0 if it went as the steady clock
  /// did, give or take kClockTolerance.
  std::chrono::nanoseconds look(const Instant& now);

 private:
  Instant last_;
};

}  // namespace aurasim::node
