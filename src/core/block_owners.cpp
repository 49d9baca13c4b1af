#include "core/block_owners.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/block.h"

namespace aurasim::core {
namespace {

/// A body of usual speed goes no farther in a step, gaps of contacts included, m.
constexpr double kUsualWay_m = 0.4;
/// Between the interior of a region and the surroundings of others, m. More than rounding.
constexpr double kApart_m = 0.001;

/// The first edge of blocks from which on their centres are at `x` or beyond.
double edge_at(double x, double side_m) { return std::isfinite(x) ? std::ceil(x / side_m - 0.5) * side_m : x; }

Rectangle grown(const Rectangle& area, double by_m) {
  return {area.x0 - by_m, area.y0 - by_m, area.x1 + by_m, area.y1 + by_m};
}

}  // namespace

BlockOwners::BlockOwners(const RegionMap& map, double side_m, double reach_m, double way_m)
    : map_(map), side_m_(side_m) {
  const double farther_m = std::max(0.0, way_m - kUsualWay_m);
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    const Rectangle& region = map.region(RegionId{i});
    const Rectangle blocks{edge_at(region.x0, side_m), edge_at(region.y0, side_m), edge_at(region.x1, side_m),
                           edge_at(region.y1, side_m)};
    if (blocks.x0 >= blocks.x1 || blocks.y0 >= blocks.y1) {
      throw BadRegionMap("region " + std::to_string(i) + " has no block of " + std::to_string(side_m) + " m");
    }
    blocks_.push_back(blocks);
    territories_.push_back(grown(blocks, reach_m));
    surroundings_.push_back(grown(territories_.back(), farther_m));
    interiors_.push_back(grown(blocks, -reach_m - farther_m - kApart_m));
  }
}

bool BlockOwners::are_near(RegionId a, RegionId b) const { return surroundings(a).distance(surroundings(b)) == 0; }

double usual_reach_m(const std::vector<double>& radii_m, double side_m) {
  double largest = 0;
  for (const double radius : radii_m) largest = std::max(largest, radius);
  return kBlockMargin * side_m + std::min(largest, kBlockRadius * side_m) + kUsualWay_m;
}

}  // namespace aurasim::core
