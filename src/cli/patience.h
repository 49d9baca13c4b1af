// How long somebody waits for others. Time is passed in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace aurasim::cli {

inline std::int64_t whole_seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration_cast<std::chrono::seconds>(time).count();
}

/// The limit counts from the last news, not from the beginning, and grows with how long the others take: where news
/// come every 20 s they may come after 40 s, too.
class Patience {
 public:
  using Clock = std::chrono::steady_clock;

  Patience(Clock::duration limit, Clock::time_point now) : limit_(limit), news_(now) {}

  /// `progress`: how far the others have come. More than ever before is news.
  void look(std::uint64_t progress, Clock::time_point now) {
    if (progress <= most_) return;
    most_ = progress;
    limit_ = std::max(limit_, kTimes * (now - news_));
    news_ = now;
  }
  bool is_over(Clock::time_point now) const { return now > news_ + limit_; }
  /// Since the last news.
  Clock::duration waited(Clock::time_point now) const { return now - news_; }

 private:
  static constexpr int kTimes = 2;

  Clock::duration limit_;
  Clock::time_point news_;
  std::uint64_t most_ = 0;
};

}  // namespace aurasim::cli
