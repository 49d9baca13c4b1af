// The tree along which many coupled regions tell each other, before each step, that they have ended the one before
// (docs/decisions/0064-along-a-tree.md). Region 0 is its root. Few regions need none: there each listens to all others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

class SeamTree {
 public:
  explicit SeamTree(std::size_t regions) : regions_(static_cast<std::uint32_t>(regions)) {}

  /// False: each region listens to all others.
  bool is_needed() const { return regions_ > kChildren + 1; }
  /// Nothing for the root.
  std::optional<RegionId> parent(RegionId region) const {
    if (value_of(region) == 0) return std::nullopt;
    return RegionId{(value_of(region) - 1) / kChildren};
  }
  /// Ascending.
  std::vector<RegionId> children(RegionId region) const {
    std::vector<RegionId> children;
    const std::uint32_t first = value_of(region) * kChildren + 1;
    for (std::uint32_t i = first; i < std::min(regions_, first + kChildren); ++i) children.push_back(RegionId{i});
    return children;
  }
  bool is_leaf(RegionId region) const { return value_of(region) * kChildren + 1 >= regions_; }
  bool has_edge(RegionId a, RegionId b) const { return parent(a) == b || parent(b) == a; }

  /// A region has at most so many children. With more of them it takes longer to hear and to tell them all, and with
  /// fewer there are more messages one after the other: 4 for up to 73 regions.
  static constexpr std::uint32_t kChildren = 8;

 private:
  std::uint32_t regions_;
};

}  // namespace aurasim::core
