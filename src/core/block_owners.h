// Which region owns which block (core/block.h). Where regions are coupled, a body's host is the owner of its block.
#pragma once

#include <optional>
#include <vector>

#include "core/region_map.h"

namespace aurasim::core {

class BlockOwners {
 public:
  /// A block belongs to the region that its centre lies in. `reach_m`: how far the territory of a region extends beyond
  /// its blocks. `way_m`: no body gets farther in a step, if it is not faster than promised. Throws BadRegionMap if a
  /// region has no block.
  BlockOwners(const RegionMap& map, double side_m, double reach_m, double way_m = 0);

  std::size_t size() const { return territories_.size(); }
  RegionId owner(const Block& block) const { return map_.owner(side_m_ * (block.x + 0.5), side_m_ * (block.y + 0.5)); }
  bool owns(RegionId id, const Block& block) const {
    return map_.region(id).contains(side_m_ * (block.x + 0.5), side_m_ * (block.y + 0.5));
  }
  /// The region's blocks.
  const Rectangle& blocks(RegionId id) const { return blocks_.at(value_of(id)); }
  /// Where bodies of the region usually are. Bodies that extend beyond it are far.
  const Rectangle& territory(RegionId id) const { return territories_.at(value_of(id)); }
  /// The area that bodies of the region do not reach beyond in the next step. Where one may, its host says so before
  /// (core/seam_partners.h).
  const Rectangle& surroundings(RegionId id) const { return surroundings_.at(value_of(id)); }
  /// The part of a region that no other region's surroundings come near. Empty (x0 > x1 or y0 > y1) in a small one.
  const Rectangle& interior(RegionId id) const { return interiors_.at(value_of(id)); }
  /// Do the surroundings of two regions overlap?
  bool are_near(RegionId a, RegionId b) const;

 private:
  RegionMap map_;
  double side_m_;
  std::vector<Rectangle> blocks_, territories_, surroundings_, interiors_;
};

/// How far the farthest border of a map is moved, so that regions consist of whole blocks, m.
double farthest_move_m(const RegionMap& map, double side_m);

/// The longest side of blocks that moves no border: from `longest_m` / 4 to `longest_m`, in whole millimetres. Nothing:
/// there is none.
std::optional<double> side_that_moves_none(const RegionMap& map, double longest_m);

/// How far bodies of a scene with these bounding radii usually extend beyond their blocks, m. Larger and faster ones
/// cost one message more in a step.
double usual_reach_m(const std::vector<double>& radii_m, double side_m);

}  // namespace aurasim::core
