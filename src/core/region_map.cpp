#include "core/region_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "core/fnv1a.h"

namespace aurasim::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double gap(double a0, double a1, double b0, double b1) { return std::max({b0 - a1, a0 - b1, 0.0}); }

std::string text(const Rectangle& r) {
  return "[" + std::to_string(r.x0) + ", " + std::to_string(r.y0) + ", " + std::to_string(r.x1) + ", " +
         std::to_string(r.y1) + "]";
}

Rectangle hull_of(const std::vector<Rectangle>& boxes) {
  Rectangle hull = boxes.front();
  for (const Rectangle& box : boxes) hull = hull_of(hull, box);
  return hull;
}

/// Throws unless the boxes have a positive, finite size and none overlaps another.
void check_boxes(const std::vector<Rectangle>& boxes) {
  if (boxes.empty()) throw BadRegionMap("no box");
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Rectangle& b = boxes[i];
    const bool finite = std::isfinite(b.x0) && std::isfinite(b.y0) && std::isfinite(b.x1) && std::isfinite(b.y1);
    if (!finite || b.x0 >= b.x1 || b.y0 >= b.y1) {
      throw BadRegionMap("box " + std::to_string(i) + " " + text(b) + " is empty: x0 < x1 and y0 < y1 are needed");
    }
    for (std::size_t j = 0; j < i; ++j) {
      const Rectangle& c = boxes[j];
      if (b.x0 < c.x1 && c.x0 < b.x1 && b.y0 < c.y1 && c.y0 < b.y1) {
        throw BadRegionMap("boxes " + std::to_string(j) + " " + text(c) + " and " + std::to_string(i) + " " + text(b) +
                           " overlap");
      }
    }
  }
}

/// Throws unless the boxes fill their hull. If none overlap, they do exactly when every cell of the grid of their edges
/// has an owner.
void check_no_gap(const std::vector<Rectangle>& boxes, const Rectangle& hull) {
  std::set<double> xs, ys;
  for (const Rectangle& b : boxes) {
    xs.insert({b.x0, b.x1});
    ys.insert({b.y0, b.y1});
  }
  for (auto x = xs.begin(); std::next(x) != xs.end(); ++x) {
    for (auto y = ys.begin(); std::next(y) != ys.end(); ++y) {
      const bool owned =
          std::any_of(boxes.begin(), boxes.end(), [&](const Rectangle& b) { return b.contains(*x, *y); });
      if (!owned) {
        throw BadRegionMap("the boxes leave a gap inside " + text(hull) + " at [" + std::to_string(*x) + ", " +
                           std::to_string(*y) + "]");
      }
    }
  }
}

}  // namespace

double Rectangle::distance(double x, double y) const {
  const double dx = std::max({x0 - x, x - x1, 0.0});
  const double dy = std::max({y0 - y, y - y1, 0.0});
  return dx == 0 ? dy : dy == 0 ? dx : std::hypot(dx, dy);
}

double Rectangle::distance(const Rectangle& other) const {
  return std::hypot(gap(x0, x1, other.x0, other.x1), gap(y0, y1, other.y0, other.y1));
}

RegionMap::RegionMap(std::vector<Rectangle> tiles) : regions_(std::move(tiles)) {
  if (regions_.size() > 1) {
    for (const Rectangle& r : regions_) narrowest_m_ = std::min({narrowest_m_, r.x1 - r.x0, r.y1 - r.y0});
  }
  const Rectangle hull = hull_of(regions_);
  for (Rectangle& r : regions_) {
    if (r.x0 == hull.x0) r.x0 = -kInfinity;
    if (r.y0 == hull.y0) r.y0 = -kInfinity;
    if (r.x1 == hull.x1) r.x1 = kInfinity;
    if (r.y1 == hull.y1) r.y1 = kInfinity;
  }
}

RegionMap RegionMap::columns(std::size_t count, double width_m) {
  if (count == 0 || !(width_m > 0)) throw BadRegionMap("columns need a count and a width above 0");
  std::vector<Rectangle> tiles;
  const double left = -0.5 * static_cast<double>(count) * width_m;
  for (std::size_t i = 0; i < count; ++i) {
    tiles.push_back({left + static_cast<double>(i) * width_m, -1, left + static_cast<double>(i + 1) * width_m, 1});
  }
  RegionMap map(std::move(tiles));
  if (count > 1) map.narrowest_m_ = width_m;
  return map;
}

RegionMap RegionMap::grid(std::size_t rows, std::size_t columns, double cell_x_m, double cell_y_m) {
  if (rows == 0 || columns == 0 || !(cell_x_m > 0) || !(cell_y_m > 0)) {
    throw BadRegionMap("a grid needs rows, columns and cell sizes above 0");
  }
  std::vector<Rectangle> tiles;
  const double left = -0.5 * static_cast<double>(columns) * cell_x_m;
  const double bottom = -0.5 * static_cast<double>(rows) * cell_y_m;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const double x = left + static_cast<double>(c) * cell_x_m;
      const double y = bottom + static_cast<double>(r) * cell_y_m;
      const double x1 = left + static_cast<double>(c + 1) * cell_x_m;
      const double y1 = bottom + static_cast<double>(r + 1) * cell_y_m;
      tiles.push_back({x, y, x1, y1});
    }
  }
  return RegionMap(std::move(tiles));
}

RegionMap RegionMap::brick(std::size_t rows, std::size_t columns, double cell_x_m, double cell_y_m) {
  RegionMap map = grid(rows, columns, cell_x_m, cell_y_m);
  for (std::size_t r = 1; r < rows; r += 2) {
    for (std::size_t c = 0; c < columns; ++c) {
      Rectangle& tile = map.regions_[r * columns + c];
      tile.x0 += 0.5 * cell_x_m;  // an infinite edge stays infinite
      tile.x1 += 0.5 * cell_x_m;
    }
  }
  return map;
}

RegionMap RegionMap::boxes(std::vector<Rectangle> boxes) {
  check_boxes(boxes);
  check_no_gap(boxes, hull_of(boxes));
  return RegionMap(std::move(boxes));
}

RegionId RegionMap::owner(double x, double y) const {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].contains(x, y)) return RegionId{static_cast<std::uint32_t>(i)};
  }
  return RegionId{0};  // NaN: any region will do, as long as there is exactly one owner
}

std::vector<RegionId> RegionMap::neighbours(RegionId id, double distance_m) const {
  std::vector<RegionId> found;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const RegionId other{static_cast<std::uint32_t>(i)};
    if (other != id && region(id).distance(regions_[i]) <= distance_m) found.push_back(other);
  }
  return found;
}

std::uint64_t RegionMap::version() const {
  Fnv1a hash;
  for (const Rectangle& r : regions_) {
    for (const double edge : {r.x0, r.y0, r.x1, r.y1}) hash.add_word(std::bit_cast<std::uint64_t>(edge));
  }
  return hash.value();
}

}  // namespace aurasim::core
