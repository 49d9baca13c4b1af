// Points in hashed cubic cells: which bodies may be within a distance of a box. Rebuilt each step, without
// allocation once warm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

class SpatialGrid {
 public:
  /// Forgets everything; cells of `cell_m`.
  void clear(double cell_m);

  void add(std::uint32_t index, const Vec3& p);

  /// Sorts what was added into cells. Call once before any query.
  void build();

  /// Calls `visit(index)` for every point within the box [lo, hi] grown to whole cells (a superset).
  template <class Visit>
  void for_each_in(const Vec3& lo, const Vec3& hi, Visit&& visit) const {
    if (points_.empty()) return;
    const Cell a = cell_of(lo);
    const Cell b = cell_of(hi);
    const double cells = double(b.x - a.x + 1) * double(b.y - a.y + 1) * double(b.z - a.z + 1);
    if (cells > 4.0 * static_cast<double>(points_.size()) + 64) {  // a box larger than the world: look at every point
      for (const Point& point : points_) visit(point.index);
      return;
    }
    for (std::int64_t x = a.x; x <= b.x; ++x) {
      for (std::int64_t y = a.y; y <= b.y; ++y) {
        for (std::int64_t z = a.z; z <= b.z; ++z) visit_cell({x, y, z}, visit);
      }
    }
  }

  bool empty() const { return points_.empty(); }

 private:
  struct Cell {
    std::int64_t x, y, z;
    bool operator==(const Cell&) const = default;
  };
  struct Point {
    Cell cell;
    std::uint32_t index;
    std::uint32_t bucket;
  };

  Cell cell_of(const Vec3& p) const;
  std::uint32_t bucket_of(const Cell& cell) const;

  template <class Visit>
  void visit_cell(const Cell& cell, Visit& visit) const {
    const std::uint32_t bucket = bucket_of(cell);
    for (std::uint32_t i = starts_[bucket]; i < starts_[bucket + 1]; ++i) {
      if (sorted_[i].cell == cell) visit(sorted_[i].index);
    }
  }

  double cell_m_ = 1;
  std::uint32_t mask_ = 0;
  std::vector<Point> points_;
  std::vector<Point> sorted_;
  std::vector<std::uint32_t> starts_;
};

}  // namespace aurasim::core
