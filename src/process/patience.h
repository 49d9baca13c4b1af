// Time limits for waiting for other processes. Time is passed in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace aurasim::process {

inline std::int64_t whole_seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration_cast<std::chrono::seconds>(time).count();
}

/// The limit counts from the last news, not from the beginning. It grows with the intervals between news: if news come
/// every 20 s, the next may take 40 s. It also grows when the caller itself is slow: a caller that cannot look ten
/// times a second is on a busy machine, as the others may be.
class Patience {
 public:
  using Clock = std::chrono::steady_clock;

  Patience(Clock::duration limit, Clock::time_point now) : limit_(limit), news_(now), looked_(now) {}

  /// To be called often. `progress`: how far the others have come. A new maximum is news.
  void look(std::uint64_t progress, Clock::time_point now) {
    limit_ = std::max(limit_, kTimesALook * (now - looked_));
    looked_ = now;
    if (progress <= most_) return;
    most_ = progress;
    limit_ = std::max(limit_, kTimesTheNews * (now - news_));
    news_ = now;
  }
  bool is_over(Clock::time_point now) const { return now > news_ + limit_; }
  /// Since the last news.
  Clock::duration waited(Clock::time_point now) const { return now - news_; }

 private:
  static constexpr int kTimesTheNews = 2, kTimesALook = 60;

  Clock::duration limit_;
  Clock::time_point news_, looked_;
  std::uint64_t most_ = 0;
};

}  // namespace aurasim::process
