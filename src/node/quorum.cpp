#include "node/quorum.h"

#include <algorithm>

namespace aurasim::node {

Quorum::Quorum(core::RegionId self, std::uint32_t regions) : self_(self) {
  for (std::uint32_t r = 0; r < regions; ++r) members_.insert(core::RegionId{r});
}

Standing Quorum::judge(const std::map<core::RegionId, PeerSign>& signs, std::chrono::steady_clock::time_point now) {
  std::set<core::RegionId> lost;
  for (const auto& [region, sign] : signs) {
    if (sign.left) members_.erase(region);
    if (sign.lost && members_.contains(region)) lost.insert(region);
  }
  if (!std::includes(lost_.begin(), lost_.end(), lost.begin(), lost.end())) lost_since_ = now;
  lost_ = std::move(lost);
  if (lost_.empty()) return Standing::kGoOn;

  // Only messages received after the loss count. An earlier one may have been under way when the link was cut.
  std::set<core::RegionId> here = {self_};
  for (const auto& [region, sign] : signs) {
    if (members_.contains(region) && !sign.lost && sign.heard > lost_since_) here.insert(region);
  }
  const bool half_with_lowest = 2 * here.size() == members_.size() && here.contains(*members_.begin());
  if (2 * here.size() > members_.size() || half_with_lowest) return Standing::kGoOn;
  return here.size() + lost_.size() == members_.size() ? Standing::kCutOff : Standing::kWait;
}

}  // namespace aurasim::node
