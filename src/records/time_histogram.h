// Durations of a whole run, in memory of fixed size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace aurasim::records {

/// Counts durations in classes, each 2% longer than the one before, from 1 us to 100 s.
class TimeHistogram {
 public:
  void note(double seconds) {
    const double place = std::log(std::max(seconds, kShortest_s) / kShortest_s) / std::log(kRatio);
    ++counts_[std::min(counts_.size() - 1, static_cast<std::size_t>(place))];
    ++count_;
    longest_s_ = std::max(longest_s_, seconds);
  }
  std::uint64_t count() const { return count_; }
  double longest_s() const { return longest_s_; }
  /// The duration below which the share `q` (0..1) lies, at most 2% too long; 0 if there is none.
  double percentile_s(double q) const {
    const auto rank = static_cast<std::uint64_t>(q * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < counts_.size() && count_ > 0; ++i) {
      below += counts_[i];
      if (below > rank) return std::min(longest_s_, kShortest_s * std::pow(kRatio, static_cast<double>(i) + 1));
    }
    return longest_s_;
  }

 private:
  static constexpr double kShortest_s = 1e-6;
  static constexpr double kRatio = 1.02;
  static constexpr std::size_t kClasses = 931;  // 1.02 to this power is 1e8

  std::array<std::uint64_t, kClasses> counts_{};
  std::uint64_t count_ = 0;
  double longest_s_ = 0;
};

}  // namespace aurasim::records
