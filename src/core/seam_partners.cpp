#include "core/seam_partners.h"

#include <algorithm>
#include <numeric>

namespace aurasim::core {
namespace {

/// Is there a corner of blocks of both regions and a third one? Rectangles that meet two by two have a common point.
bool share_a_corner_with_a_third(const BlockOwners& owners, RegionId a, RegionId b) {
  const auto meet = [&](RegionId x, RegionId y) { return owners.blocks(x).distance(owners.blocks(y)) == 0; };
  if (!meet(a, b)) return false;
  for (std::uint32_t i = 0; i < owners.size(); ++i) {
    const RegionId third{i};
    if (third != a && third != b && meet(a, third) && meet(b, third)) return true;
  }
  return false;
}

}  // namespace

SeamPartners::SeamPartners(const BlockOwners& owners) : count_(owners.size()), parents_(count_) {
  for (std::uint32_t a = 0; a < count_; ++a) {
    for (std::uint32_t b = 0; b < count_; ++b) {
      are_near_.push_back(owners.are_near(RegionId{a}, RegionId{b}));
      share_corners_.push_back(share_a_corner_with_a_third(owners, RegionId{a}, RegionId{b}));
    }
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

bool SeamPartners::are_partners(RegionId a, RegionId b) const { return are_near_[index(a, b)] || group(a) == group(b); }

bool SeamPartners::may_share_chains(RegionId a, RegionId b) const {
  return share_corners_[index(a, b)] || group(a) == group(b);
}

std::uint32_t SeamPartners::group(RegionId region) const {
  std::uint32_t first = value_of(region);
  while (parents_[first] != first) first = parents_[first];
  return first;
}

}  // namespace aurasim::core
