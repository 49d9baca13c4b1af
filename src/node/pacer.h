// Computes when each step is due. All nodes share one epoch (a point in time), so their steps are phase-aligned. The
// epoch is given in wall-clock time, which hosts have in common. From then on the steady clock keeps the pace, so that
// setting the wall clock makes no node run ahead or wait. Time is passed in.
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

/// Wall clocks that differ by less than this are taken as equal: an epoch then holds to the nanosecond, however long
/// its message was under way. If they differ by more, the epoch counts from the moment when the message came.
inline constexpr std::chrono::milliseconds kClockTolerance{250};

class Pacer {
 public:
  /// `step_s`: duration of a step in seconds. With `wait` false every step is due at once.
  Pacer(double step_s, bool wait) : step_s_(step_s), wait_(wait) {}

  /// Step `first` is due at `epoch_ns` (wall clock, nanoseconds since 1970), the others follow. `clock_ahead`: how far
  /// the wall clock of the host that named the epoch is ahead of ours.
  void set_epoch(core::Step first, std::int64_t epoch_ns, std::chrono::nanoseconds clock_ahead, const Instant& now);

  /// Step `step` is due at `epoch_ns` (as in set_epoch()); later steps follow at `rate` simulated seconds per second.
  void set_rate(double rate, core::Step step, std::int64_t epoch_ns, std::chrono::nanoseconds clock_ahead,
                const Instant& now);
  double rate() const { return rate_; }

  /// The time when `step` is due, which may be past.
  std::chrono::steady_clock::time_point due(core::Step step) const;
  /// Time until `step` is due; 0 if it is due already.
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
