// How much of one kind a process may send. A bucket of tokens for each; time is passed in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>

namespace aurasim::dds {

/// `Source`: has operator<.
template <class Source>
class RateLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  RateLimit(double per_second, double at_once) : per_second_(per_second), at_once_(at_once) {}

  /// False: this is one too many.
  bool allows(const Source& source, Time now) {
    if (buckets_.size() >= kMostSources && !buckets_.contains(source)) forget_the_quiet(now);
    if (buckets_.size() >= kMostSources && !buckets_.contains(source)) return false;
    Bucket& bucket = buckets_.try_emplace(source, Bucket{at_once_, now}).first->second;
    bucket.tokens = tokens_of(bucket, now);
    bucket.filled = now;
    if (bucket.tokens < 1) return false;
    bucket.tokens -= 1;
    return true;
  }

  /// Each source that is known may send so many more, up to as many as at once.
  void allow_more(double messages) {
    for (auto& [source, bucket] : buckets_) bucket.tokens = std::min(at_once_, bucket.tokens + messages);
  }

 private:
  static constexpr std::size_t kMostSources = 1024;

  struct Bucket {
    double tokens = 0;
    Time filled;
  };
  double tokens_of(const Bucket& bucket, Time now) const {
    return std::min(at_once_, bucket.tokens + per_second_ * std::chrono::duration<double>(now - bucket.filled).count());
  }
  void forget_the_quiet(Time now) {
    std::erase_if(buckets_, [&](const auto& entry) { return tokens_of(entry.second, now) >= at_once_; });
  }

  double per_second_, at_once_;
  std::map<Source, Bucket> buckets_;
};

}  // namespace aurasim::dds
