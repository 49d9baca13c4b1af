#include "core/seam_partners.h"

#include <algorithm>
#include <numeric>

namespace aurasim::core {

SeamPartners::SeamPartners(const BlockOwners& owners) : count_(owners.size()), parents_(count_) {
  for (std::uint32_t a = 0; a < count_; ++a) {
    for (std::uint32_t b = 0; b < count_; ++b) are_near_.push_back(owners.are_near(RegionId{a}, RegionId{b}));
  }
  begin({});
}

void SeamPartners::begin(std::span<const Introduction> pairs) {
  std::iota(parents_.begin(), parents_.end(), 0);
  for (const Introduction& pair : pairs) {
    const std::uint32_t a = group(pair.a), b = group(pair.b);
    parents_[std::max(a, b)] = std::min(a, b);
  }
}

bool SeamPartners::are_partners(RegionId a, RegionId b) const {
  return are_near_[value_of(a) * count_ + value_of(b)] || group(a) == group(b);
}

std::uint32_t SeamPartners::group(RegionId region) const {
  std::uint32_t first = value_of(region);
  while (parents_[first] != first) first = parents_[first];
  return first;
}

}  // namespace aurasim::core
