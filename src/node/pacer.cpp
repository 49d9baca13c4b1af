#include "node/pacer.h"

#include <algorithm>
#include <cmath>

namespace aurasim::node {

std::int64_t wall_clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(WallClock::now().time_since_epoch()).count();
}

void Pacer::set_epoch(core::Step first, std::int64_t epoch_ns) {
  first_ = first;
  epoch_ns_ = epoch_ns;
}

std::int64_t Pacer::due_ns(core::Step step) const {
  return epoch_ns_ + std::llround(static_cast<double>(step - first_) * step_s_ / rate_ * 1e9);
}

void Pacer::set_rate(core::Step step, double rate) {
  set_epoch(step, due_ns(step));
  rate_ = rate;
}

std::chrono::nanoseconds Pacer::until(core::Step step) const {
  if (!wait_) return std::chrono::nanoseconds(0);
  return std::chrono::nanoseconds(std::max<std::int64_t>(0, due_ns(step) - wall_clock_ns()));
}

}  // namespace aurasim::node
