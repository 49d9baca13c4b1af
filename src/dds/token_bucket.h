// How much somebody may still do: fills with time up to a burst. Pure; time is passed in.
#pragma once

#include <algorithm>
#include <chrono>

namespace aurasim::dds {

class TokenBucket {
 public:
  using Time = std::chrono::nanoseconds;  ///< of any clock that does not go back

  TokenBucket(double per_s, double burst, Time now) : per_s_(per_s), burst_(burst), level_(burst), filled_(now) {}

  /// False, and nothing is taken, when less than `amount` is there.
  bool take(double amount, Time now) {
    level_ = std::min(burst_, level_ + per_s_ * std::chrono::duration<double>(now - filled_).count());
    filled_ = now;
    if (level_ < amount) return false;
    level_ -= amount;
    return true;
  }

 private:
  double per_s_, burst_, level_;
  Time filled_;
};

}  // namespace aurasim::dds
