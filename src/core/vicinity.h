// A region and those that listen to it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/region_map.h"

namespace aurasim::core {

struct Vicinity {
  /// Throws BadRegionMap when a region has more neighbours than bits in a set of them (64).
  Vicinity(const RegionMap& map, RegionId self, double neighbour_distance_m);

  const RegionMap& map;
  RegionId self;
  double neighbour_distance_m;
  std::vector<RegionId> neighbours;  ///< ascending

  const Rectangle& home() const { return map.region(self); }
  /// Bits of the neighbours whose territory is at most `distance_m` from `p`.
  std::uint64_t within(const Vec3& p, double distance_m) const;
  /// No other region's territory is within `distance_m` of `p`.
  bool deep_inside(const Vec3& p, double distance_m) const;
  bool is_neighbour(RegionId id) const;
  /// Do two other regions listen to each other?
  bool are_neighbours(RegionId a, RegionId b) const;
  /// The bit of one neighbour; 0 for ourselves and for regions that do not listen.
  std::uint64_t bit_of(RegionId id) const;
};

}  // namespace aurasim::core
