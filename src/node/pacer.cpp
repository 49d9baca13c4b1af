#include "node/pacer.h"

#include <algorithm>
#include <cmath>

#include "core/wall_clock.h"

namespace aurasim::node {

using std::chrono::nanoseconds;

Instant read_clocks() { return {std::chrono::steady_clock::now(), core::wall_clock_ns()}; }

void Pacer::set_epoch(core::Step first, std::int64_t epoch_ns, nanoseconds clock_ahead, const Instant& now) {
  const bool is_one_clock = std::chrono::abs(clock_ahead) < kClockTolerance;
  first_ = first;
  epoch_ = now.steady + nanoseconds(epoch_ns - now.wall_ns) - (is_one_clock ? nanoseconds(0) : clock_ahead);
}

std::chrono::steady_clock::time_point Pacer::due(core::Step step) const {
  return epoch_ + nanoseconds(std::llround(static_cast<double>(step - first_) * step_s_ / rate_ * 1e9));
}

void Pacer::set_rate(double rate, core::Step step, std::int64_t epoch_ns, nanoseconds clock_ahead, const Instant& now) {
  set_epoch(step, epoch_ns, clock_ahead, now);
  rate_ = rate;
}

nanoseconds Pacer::until(core::Step step, const Instant& now) const {
  if (!wait_) return nanoseconds(0);
  return std::max<nanoseconds>(nanoseconds(0), due(step) - now.steady);
}

nanoseconds ClockWatch::look(const Instant& now) {
  const nanoseconds jump = nanoseconds(now.wall_ns - last_.wall_ns) - nanoseconds(now.steady - last_.steady);
  last_ = now;
  return std::chrono::abs(jump) < kClockTolerance ? nanoseconds(0) : jump;
}

}  // namespace aurasim::node
