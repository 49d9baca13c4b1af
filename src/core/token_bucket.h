// Token bucket for rate limits: fills at a rate up to a burst. Has no clock: time is passed in.
#pragma once

#include <algorithm>
#include <chrono>

namespace aurasim::core {

class TokenBucket {
 public:
  using Time = std::chrono::nanoseconds;  ///< time of any monotonic clock

  /// Starts full. `per_s`: tokens per second; `burst`: most tokens that it holds.
  TokenBucket(double per_s, double burst, Time now = {}) : per_s_(per_s), burst_(burst), level_(burst), filled_(now) {}

  /// Takes `amount` tokens. Returns false and takes nothing if there are fewer.
  bool take(double amount, Time now) {
    fill(now);
    if (level_ < amount) return false;
    level_ -= amount;
    return true;
  }

  /// Takes one token even if none is left. Returns how long to wait until it would have been there; 0 if it was.
  Time charge(Time now) {
    fill(now);
    level_ -= 1;
    if (level_ >= 0) return {};
    return std::chrono::duration_cast<Time>(std::chrono::duration<double>(-level_ / per_s_));
  }

  void add(double amount) { level_ = std::min(burst_, level_ + amount); }

  bool is_spent(Time now) const { return level_at(now) < 1; }
  bool is_full(Time now) const { return level_at(now) >= burst_; }

 private:
  double level_at(Time now) const {
    return std::min(burst_, level_ + per_s_ * std::chrono::duration<double>(now - filled_).count());
  }
  void fill(Time now) {
    level_ = level_at(now);
    filled_ = now;
  }

  double per_s_, burst_, level_;
  Time filled_;
};

}  // namespace aurasim::core
