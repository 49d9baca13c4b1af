// So many at once, and so many a second from then on. Time is passed in.
#pragma once

#include <algorithm>
#include <chrono>

namespace aurasim::overseer {

class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimit(double burst, double per_s) : burst_(burst), per_s_(per_s), left_(burst) {}

  /// One more. Returns how long to wait until there would have been room for it; zero: there is.
  Clock::duration take(Clock::time_point now) {
    left_ = left_at(now) - 1;
    counted_ = now;
    if (left_ >= 0) return {};
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(-left_ / per_s_));
  }
  bool is_spent(Clock::time_point now) const { return left_at(now) < 1; }
  bool is_unused(Clock::time_point now) const { return left_at(now) >= burst_; }

 private:
  double left_at(Clock::time_point now) const {
    return std::min(burst_, left_ + std::chrono::duration<double>(now - counted_).count() * per_s_);
  }

  double burst_;
  double per_s_;
  double left_;
  Clock::time_point counted_{};  ///< when there were so many left
};

}  // namespace aurasim::overseer
