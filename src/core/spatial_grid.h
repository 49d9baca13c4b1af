// Finds the points within a box. Space is divided into square vertical columns. Worlds are wider than they are high, so
// a column holds few points. The columns of a row lie side by side in a hash table, so a row of the box is one stretch
// of memory, without a look-up for each column. Rebuilt each step, without allocation once warm.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

class SpatialGrid {
 public:
  /// Removes all points and sets the side of the columns, metres.
  void clear(double cell_m);

  void add(std::uint32_t index, const Vec3& p);

  /// Sorts the added points into columns. The hash table has room for `most` points. Call once before any query.
  void build(std::size_t most = 0);

  /// Calls `visit(index)` once for every point within the box [lo, hi].
  template <class Visit>
  void for_each_in(const Vec3& lo, const Vec3& hi, Visit&& visit) const {
    if (empty()) return;
    const Box box{lo, hi};
    const std::int64_t first = along(lo.x()), last = along(hi.x());
    const std::int64_t begin = along(lo.y()), columns = along(hi.y()) - begin + 1;
    const double cells = double(last - first + 1) * double(columns);
    // the box is larger than the world
    if (columns > mask_ || cells > 4.0 * static_cast<double>(points_.size()) + 64) {
      for (const Point& point : points_) visit_if(box.holds(point), point, visit);
      return;
    }
    for (std::int64_t row = first; row <= last; ++row) {
      const std::uint32_t from = bucket_of(row, begin);
      const std::uint32_t to = from + static_cast<std::uint32_t>(columns);
      visit_buckets(from, std::min(to, mask_ + 1), row, box, visit);
      if (to > mask_ + 1) visit_buckets(0, to - mask_ - 1, row, box, visit);
    }
  }

  bool empty() const { return points_.empty(); }

 private:
  struct Point {
    double x, y, z;
    std::int32_t row;
    std::uint32_t index;
  };
  /// Comparisons are written so that a coordinate that is NaN counts as inside: slower, never wrong.
  struct Box {
    Vec3 lo, hi;
    bool holds(const Point& p) const {
      return !(p.x < lo.x()) && !(p.x > hi.x()) && !(p.y < lo.y()) && !(p.y > hi.y()) && !(p.z < lo.z()) &&
             !(p.z > hi.z());
    }
  };

  /// Row or column of a coordinate. All far coordinates, and NaN, share the outermost one: slower, never wrong.
  std::int64_t along(double x) const {
    constexpr double kFar = 1e9;
    const double c = x * per_m_;
    if (!(c > -kFar)) return static_cast<std::int64_t>(-kFar);
    if (c > kFar) return static_cast<std::int64_t>(kFar);
    const auto towards_zero = static_cast<std::int64_t>(c);
    return towards_zero - (static_cast<double>(towards_zero) > c ? 1 : 0);
  }

  std::uint32_t bucket_of(std::int64_t row, std::int64_t column) const {
    const std::uint64_t start = (static_cast<std::uint64_t>(row) * 0x9E3779B97F4A7C15ull) >> 32;
    return static_cast<std::uint32_t>(start + static_cast<std::uint64_t>(column)) & mask_;
  }
  std::uint32_t bucket_of(const Point& point) const { return bucket_of(point.row, along(point.y)); }

  template <class Visit>
  static void visit_if(bool inside, const Point& point, Visit& visit) {
    if (inside) visit(point.index);
  }

  /// Visits the points of `row` within `box` in buckets [from, to).
  template <class Visit>
  void visit_buckets(std::uint32_t from, std::uint32_t to, std::int64_t row, const Box& box, Visit& visit) const {
    for (std::uint32_t i = starts_[from]; i < starts_[to]; ++i) {
      visit_if(sorted_[i].row == row && box.holds(sorted_[i]), sorted_[i], visit);
    }
  }

  double per_m_ = 1;  ///< columns per metre
  std::uint32_t mask_ = 0;
  std::vector<Point> points_;
  std::vector<Point> sorted_;
  std::vector<std::uint32_t> buckets_;  ///< by point of points_: its bucket
  std::vector<std::uint32_t> starts_;
};

}  // namespace aurasim::core
