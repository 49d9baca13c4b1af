#include "core/nearness.h"

#include <algorithm>
#include <utility>

#include "core/seam_tree.h"

namespace aurasim::core {

bool are_near(const RegionMap& map, const Nearness& nearness, RegionId a, RegionId b) {
  if (nearness.owners == nullptr) return map.region(a).distance(map.region(b)) <= nearness.distance_m;
  const SeamTree tree(map.size());
  return !tree.is_needed() || tree.has_edge(a, b) || nearness.owners->are_near(a, b);
}

std::vector<RegionId> regions_near(const RegionMap& map, const Nearness& nearness, RegionId self) {
  std::vector<RegionId> near;
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    const RegionId other{i};
    if (other != self && are_near(map, nearness, self, other)) near.push_back(other);
  }
  return near;
}

std::vector<std::vector<RegionId>> all_near(const RegionMap& map, const Nearness& nearness) {
  std::vector<std::vector<RegionId>> near;
  for (std::uint32_t i = 0; i < map.size(); ++i) near.push_back(regions_near(map, nearness, RegionId{i}));
  return near;
}

int hops_from(RegionId start, std::span<const std::vector<RegionId>> near) {
  std::vector<bool> is_reached(near.size(), false);
  std::vector<RegionId> wave = {start};
  is_reached[value_of(start)] = true;
  for (int hops = 0;; ++hops) {
    std::vector<RegionId> next;
    for (const RegionId region : wave) {
      for (const RegionId other : near[value_of(region)]) {
        if (is_reached[value_of(other)]) continue;
        is_reached[value_of(other)] = true;
        next.push_back(other);
      }
    }
    if (next.empty()) return hops;
    wave = std::move(next);
  }
}

int hops_across(std::span<const std::vector<RegionId>> near) {
  int most = 0;
  for (std::uint32_t i = 0; i < near.size(); ++i) most = std::max(most, hops_from(RegionId{i}, near));
  return most;
}

}  // namespace aurasim::core
