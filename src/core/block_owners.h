// Which region owns which block (core/block.h). Where regions are coupled, a body's host is the owner of its block.
#pragma once

#include <vector>

#include "core/region_map.h"

namespace aurasim::core {

class BlockOwners {
 public:
  /// A block belongs to the region that its centre lies in. `reach_m`: how far the territory of a region extends beyond
  /// its blocks. Throws BadRegionMap if a region has no block.
  BlockOwners(const RegionMap& map, double side_m, double reach_m);

  std::size_t size() const { return territories_.size(); }
  RegionId owner(const Block& block) const { return map_.owner(side_m_ * (block.x + 0.5), side_m_ * (block.y + 0.5)); }
  /// Where bodies of the region usually are. Bodies that extend beyond it are far.
  const Rectangle& territory(RegionId id) const { return territories_.at(value_of(id)); }

 private:
  RegionMap map_;
  double side_m_;
  std::vector<Rectangle> territories_;
};

/// How far bodies of a scene with these bounding radii usually extend beyond their blocks, m. Larger and faster ones
/// cost one message more in a step.
double usual_reach_m(const std::vector<double>& radii_m, double side_m);

}  // namespace aurasim::core
