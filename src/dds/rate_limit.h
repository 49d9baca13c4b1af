// Limits the rate of messages of one kind for each source: one token bucket per source. Time is passed in.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>

#include "core/token_bucket.h"

namespace aurasim::dds {

/// `Source` identifies a sender and needs operator<.
template <class Source>
class RateLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  RateLimit(double per_second, double at_once) : per_second_(per_second), at_once_(at_once) {}

  /// Returns whether one more message of `source` is allowed, and takes a token if so.
  bool allows(const Source& source, Time now) {
    if (buckets_.size() >= kMostSources && !buckets_.contains(source)) forget_the_quiet(now);
    if (buckets_.size() >= kMostSources && !buckets_.contains(source)) return false;
    return buckets_.try_emplace(source, per_second_, at_once_, now.time_since_epoch())
        .first->second.take(1, now.time_since_epoch());
  }

  /// Adds tokens to every known source, up to the size of its bucket.
  void allow_more(double messages) {
    for (auto& [source, bucket] : buckets_) bucket.add(messages);
  }

 private:
  static constexpr std::size_t kMostSources = 1024;

  void forget_the_quiet(Time now) {
    std::erase_if(buckets_, [&](const auto& entry) { return entry.second.is_full(now.time_since_epoch()); });
  }

  double per_second_, at_once_;
  std::map<Source, core::TokenBucket> buckets_;
};

}  // namespace aurasim::dds
