#include "process/keepers.h"

#include <algorithm>
#include <optional>

namespace aurasim::process {
namespace {

struct Ring {
  std::uint32_t regions;
  const std::map<core::RegionId, std::uint16_t>& hosts;

  bool share_a_host(core::RegionId a, core::RegionId b) const {
    const auto of_a = hosts.find(a), of_b = hosts.find(b);
    return of_a == hosts.end() || of_b == hosts.end() || of_a->second == of_b->second;
  }

  /// The first region from `begin` on that is none of `others` and shares a host with as few of them as possible.
  std::optional<core::RegionId> choose(std::uint32_t begin, const std::vector<core::RegionId>& others) const {
    std::optional<core::RegionId> best;
    std::ptrdiff_t fewest = 0;
    for (std::uint32_t i = 0; i < regions; ++i) {
      const core::RegionId candidate{(begin + i) % regions};
      if (std::ranges::find(others, candidate) != others.end()) continue;
      // The host of the region itself, which is the first of `others`, weighs more than that of the other keeper.
      std::ptrdiff_t shared = 0;
      for (const core::RegionId other : others) {
        shared += share_a_host(candidate, other) ? (other == others.front() ? 2 : 1) : 0;
      }
      if (best && shared >= fewest) continue;
      best = candidate;
      fewest = shared;
    }
    return best;
  }
};

}  // namespace

std::vector<core::RegionId> keepers_of(core::RegionId region, std::uint32_t regions,
                                       const std::map<core::RegionId, std::uint16_t>& hosts) {
  const Ring ring{regions, hosts};
  std::vector<core::RegionId> chosen = {region};
  for (const std::uint32_t distance : {1U, std::max(1U, regions / 2)}) {
    if (const auto next = ring.choose(core::value_of(region) + distance, chosen)) chosen.push_back(*next);
  }
  chosen.erase(chosen.begin());
  return chosen;
}

}  // namespace aurasim::process
