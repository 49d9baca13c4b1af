// Which regions always listen to each other. Others may do so for some time (core/introductions.h).
#pragma once

#include <span>
#include <vector>

#include "core/block_owners.h"
#include "core/region_map.h"

namespace aurasim::core {

struct Nearness {
  // Not explicit: mostly there is only the distance.
  Nearness(double distance_in_m = 0, const BlockOwners* owners_in = nullptr)  // NOLINT(google-explicit-constructor)
      : distance_m(distance_in_m), owners(owners_in) {}

  /// Regions at most this far apart are near each other, unless they are coupled.
  double distance_m;
  /// If regions are coupled. Then all are near each other, or, if they are many, those that exchange parcels in each
  /// step, and those that a tree connects (core/seam_tree.h). Has to outlive this.
  const BlockOwners* owners;
};

bool are_near(const RegionMap& map, const Nearness& nearness, RegionId a, RegionId b);
/// The regions that are near `self`, ascending.
std::vector<RegionId> regions_near(const RegionMap& map, const Nearness& nearness, RegionId self);
/// The same for each region, by region.
std::vector<std::vector<RegionId>> all_near(const RegionMap& map, const Nearness& nearness);
/// Hops that a message of region `start` needs at most to reach the others, if each passes it on to those near it.
int hops_from(RegionId start, std::span<const std::vector<RegionId>> near);
/// The same for a message of any region.
int hops_across(std::span<const std::vector<RegionId>> near);

}  // namespace aurasim::core
