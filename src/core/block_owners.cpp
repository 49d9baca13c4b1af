#include "core/block_owners.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

/// Coordinates of the borders between regions, along x and along y, m.
std::vector<double> borders_of(const RegionMap& map) {
  std::vector<double> borders;
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    const Rectangle& region = map.region(RegionId{i});
    for (const double at : {region.x0, region.y0, region.x1, region.y1}) {
      if (std::isfinite(at)) borders.push_back(at);
    }
  }
  return borders;
}

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

double farthest_move_m(const RegionMap& map, double side_m) {
  double farthest_m = 0;
  for (const double at : borders_of(map)) farthest_m = std::max(farthest_m, std::abs(edge_at(at, side_m) - at));
  return farthest_m;
}

std::optional<double> side_that_moves_none(const RegionMap& map, double longest_m) {
  constexpr double kGrain_m = 0.001;
  const std::vector<double> borders = borders_of(map);
  const auto grains = [](double length_m) { return std::llround(length_m / kGrain_m); };
  long long common = 0;  // divides all borders
  for (const double at : borders) {
    if (std::abs(at - static_cast<double>(grains(at)) * kGrain_m) > kGrain_m / 1000) return std::nullopt;
    common = std::gcd(common, grains(at));
  }
  if (common == 0) return longest_m;
  for (long long parts = 1; common / parts >= grains(longest_m / 4); ++parts) {
    if (common % parts == 0 && common / parts <= grains(longest_m))
      return static_cast<double>(common / parts) * kGrain_m;
  }
  return std::nullopt;
}

double usual_reach_m(const std::vector<double>& radii_m, double side_m) {
  double largest = 0;
  for (const double radius : radii_m) largest = std::max(largest, radius);
  return kBlockMargin * side_m + std::min(largest, kBlockRadius * side_m) + kUsualWay_m;
}

}  // namespace aurasim::core
