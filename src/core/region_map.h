// The region map: which region owns which part of the x-y plane. Regions are rectangles with vertical boundaries; the
// outermost reach to infinity, so that every point has exactly one owner (half-open: a point on a boundary belongs to
// the higher side).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

struct Rectangle {
  double x0 = -std::numeric_limits<double>::infinity();
  double y0 = -std::numeric_limits<double>::infinity();
  double x1 = std::numeric_limits<double>::infinity();
  double y1 = std::numeric_limits<double>::infinity();

  bool contains(double x, double y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  /// Distance in the x-y plane from a point to the rectangle; 0 inside. Metres.
  double distance(double x, double y) const;
  /// Distance in the x-y plane between two rectangles; 0 when they touch or overlap. Metres.
  double distance(const Rectangle& other) const;
};

/// The smallest rectangle around both.
inline Rectangle hull_of(const Rectangle& a, const Rectangle& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// Thrown for a set of boxes that is no region map; `what()` names the boxes and the fault.
class BadRegionMap : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

class RegionMap {
 public:
  /// `count` columns of `width_m` along x, centred on the origin.
  static RegionMap columns(std::size_t count, double width_m);
  /// `rows` x `columns` cells of `cell_x_m` x `cell_y_m`, centred on the origin; region = row * columns + column.
  static RegionMap grid(std::size_t rows, std::size_t columns, double cell_x_m, double cell_y_m);
  /// Like a grid, but every odd row is shifted by half a cell: three regions meet at each corner.
  static RegionMap brick(std::size_t rows, std::size_t columns, double cell_x_m, double cell_y_m);
  /// Any rectangles that tile their bounding rectangle without overlap or gap; throws BadRegionMap otherwise.
  static RegionMap boxes(std::vector<Rectangle> boxes);

  std::size_t size() const { return regions_.size(); }
  const Rectangle& region(RegionId id) const { return regions_.at(value_of(id)); }
  RegionId owner(double x, double y) const;
  RegionId owner(const Vec3& p) const { return owner(p.x(), p.y()); }
  double distance(RegionId id, const Vec3& p) const { return region(id).distance(p.x(), p.y()); }

  /// Regions other than `id` whose rectangle is at most `distance_m` away (0: those that share an edge or a corner).
  std::vector<RegionId> neighbours(RegionId id, double distance_m = 0) const;

  /// Smallest side of any region before the outermost were extended. Infinite for one region. Metres.
  double narrowest_m() const { return narrowest_m_; }

  /// 64-bit hash of the rectangles: equal for equal maps.
  std::uint64_t version() const;

 private:
  explicit RegionMap(std::vector<Rectangle> tiles);

  std::vector<Rectangle> regions_;
  double narrowest_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace aurasim::core
