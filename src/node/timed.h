// How long the phases of a step take.
#pragma once

#include <ctime>

#include "node/phase_clock.h"

namespace aurasim::node {

inline double now_s(PhaseClock clock) {
  timespec t{};
  clock_gettime(clock == PhaseClock::kWall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Adds the time between its construction and its destruction to `seconds`.
class Timed {
 public:
  Timed(double& seconds, PhaseClock clock) : seconds_(seconds), clock_(clock), begin_s_(now_s(clock)) {}
  ~Timed() { seconds_ += now_s(clock_) - begin_s_; }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& seconds_;
  PhaseClock clock_;
  double begin_s_;
};

}  // namespace aurasim::node
