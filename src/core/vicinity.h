// A region and its neighbours: always the regions near it, and others once they are introduced (core/introductions.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/audience.h"
#include "core/nearness.h"
#include "core/region_map.h"

namespace aurasim::core {

struct Vicinity {
  /// `map` and Nearness::owners have to outlive it.
  Vicinity(const RegionMap& map, RegionId self, const Nearness& nearness);

  const RegionMap& map;
  RegionId self;
  Nearness nearness;
  std::vector<RegionId> neighbours;  ///< ascending

  /// Makes region `id` a neighbour.
  void listen_to(RegionId id);
  /// Region `id` is no neighbour any more.
  void leave(RegionId id) { std::erase(neighbours, id); }

  const Rectangle& home() const { return map.region(self); }
  /// The neighbours whose territory is at most `distance_m` from `p`.
  Audience within(const Vec3& p, double distance_m) const;
  /// The neighbours whose territory is at most `distance_m` from `box`.
  Audience within(const Rectangle& box, double distance_m) const;
  /// No other region's territory is within `distance_m` of `p`.
  bool deep_inside(const Vec3& p, double distance_m) const;
  bool is_neighbour(RegionId id) const;
  /// Are two regions so near to each other that they always listen to each other?
  bool are_near(RegionId a, RegionId b) const;
  /// The bit of one neighbour; 0 for our own region and for non-neighbours.
  Audience bit_of(RegionId id) const;
};

}  // namespace aurasim::core
