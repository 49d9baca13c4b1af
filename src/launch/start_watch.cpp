#include "launch/start_watch.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::launch {

std::optional<std::string> StartWatch::problem(const std::map<core::RegionId, messages::SeenStatus>& statuses,
                                               Clock::time_point now) {
  Progress progress;
  for (const auto& [region, seen] : statuses) progress[region] = {seen.status.state, seen.status.step};
  if (progress != progress_) moved_ = now;
  progress_ = std::move(progress);
  if (now <= moved_ + time_out_) return std::nullopt;
  std::vector<std::uint32_t> silent;
  for (std::uint32_t r = 0; r < regions_; ++r) {
    const auto seen = statuses.find(core::RegionId{r});
    if (seen == statuses.end() || now > seen->second.seen + time_out_) silent.push_back(r);
  }
  if (silent.empty()) return std::nullopt;
  return fmt::format(
      "the nodes of regions [{}] have published nothing for {} s, and the run has not begun: the launcher ends it. "
      "--start-time-out gives them more time",
      fmt::join(silent, ", "), time_out_.count());
}

}  // namespace aurasim::launch
