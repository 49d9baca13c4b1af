#include "process/exchange_watch.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "records/durations.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kWindowOfExchanges = 1s;
constexpr int kSlowWindows = 5;  ///< a busy moment is no reason for a message

}  // namespace

std::optional<std::string> ExchangeWatch::note(std::span<const double> seconds, core::RegionId waited_for,
                                               double waited_s, double limit_s, Clock::time_point now) {
  if (has_said_ || seconds.empty()) return std::nullopt;
  if (!window_began_) window_began_ = now;
  seconds_.insert(seconds_.end(), seconds.begin(), seconds.end());
  waited_s_[waited_for] += waited_s;
  if (now - *window_began_ < kWindowOfExchanges) return std::nullopt;
  window_began_ = now;
  std::optional<std::string> text = end_window(limit_s);
  seconds_.clear();
  waited_s_.clear();
  return text;
}

std::optional<std::string> ExchangeWatch::end_window(double limit_s) {
  const double median_s = records::percentile(seconds_, 0.5);
  slow_windows_ = median_s > limit_s ? slow_windows_ + 1 : 0;
  if (slow_windows_ < kSlowWindows) return std::nullopt;
  has_said_ = true;
  const auto longest = std::ranges::max_element(waited_s_, {}, [](const auto& entry) { return entry.second; });
  return fmt::format(
      "an exchange of coupled regions takes {:.3g} ms (median of the last second, 99th percentile {:.3g} ms), more "
      "than "
      "{:.3g} ms (exchange_limit): this node waits longest for region {}, {:.2g} s of all {:.2g} s. If the link to it "
      "is slow, exchange: aura hides its latency; if its node is late, it has more to compute than the others",
      1e3 * median_s, 1e3 * records::percentile(seconds_, 0.99), 1e3 * limit_s, core::value_of(longest->first),
      longest->second, std::accumulate(seconds_.begin(), seconds_.end(), 0.0));
}

}  // namespace aurasim::process
