// Points in hashed square columns: which bodies may be within a distance of a box. Worlds are wider than they are high,
// so a column holds few points, and going through it costs less than looking up each cube in it. Rebuilt each step,
// without allocation once warm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

class SpatialGrid {
 public:
  /// Forgets everything; columns of `cell_m`.
  void clear(double cell_m);

  void add(std::uint32_t index, const Vec3& p);

  /// Sorts what was added into columns. Call once before any query.
  void build();

  /// Adds a point after build(). It is in no group.
  void insert(std::uint32_t index, const Vec3& p);

  /// Calls `visit(index)` for every point within the box [lo, hi], grown to whole columns (a superset).
  template <class Visit>
  void for_each_in(const Vec3& lo, const Vec3& hi, Visit&& visit) const {
    for_each_in(
        lo, hi, [](std::uint32_t) { return false; }, visit);
  }

  /// The same without the groups for which `skip(group)` is true. A group is less than group_count() and holds some
  /// columns; where the box is larger than the world, nobody is asked.
  template <class Skip, class Visit>
  void for_each_in(const Vec3& lo, const Vec3& hi, Skip&& skip, Visit&& visit) const {
    if (empty()) return;
    const Cell a = cell_of(lo);
    const Cell b = cell_of(hi);
    const double cells = double(b.x - a.x + 1) * double(b.y - a.y + 1);
    if (cells > 4.0 * static_cast<double>(points_.size()) + 64) {  // a box larger than the world: look at every point
      for (const Point& point : points_) visit(point.index);
      for (const Late& late : late_) visit(late.point.index);
      return;
    }
    for (std::int64_t x = a.x; x <= b.x; ++x) {
      for (std::int64_t y = a.y; y <= b.y; ++y) {
        const std::uint32_t bucket = bucket_of({x, y});
        if (!late_.empty()) visit_late(bucket, {x, y}, lo.z(), hi.z(), visit);
        if (starts_[bucket] == starts_[bucket + 1] || skip(bucket)) continue;
        visit_column(bucket, {x, y}, lo.z(), hi.z(), visit);
      }
    }
  }

  std::uint32_t group_count() const { return mask_ + 1; }
  /// Does `holds(index)` for every point of the group?
  template <class Holds>
  bool all_of(std::uint32_t group, Holds&& holds) const {
    for (std::uint32_t i = starts_[group]; i < starts_[group + 1]; ++i) {
      if (!holds(sorted_[i].index)) return false;
    }
    return true;
  }
  /// Some point of a group that has any.
  std::uint32_t any_of(std::uint32_t group) const { return sorted_[starts_[group]].index; }

  bool empty() const { return points_.empty() && late_.empty(); }

 private:
  struct Cell {
    std::int64_t x, y;
    bool operator==(const Cell&) const = default;
  };
  struct Point {
    Cell cell;
    double z;
    std::uint32_t index;
    std::uint32_t bucket;
  };
  struct Late {
    Point point;
    std::uint32_t next;  ///< of the same bucket, in late_
  };
  static constexpr std::uint32_t kNone = ~0u;

  Cell cell_of(const Vec3& p) const { return {along(p.x()), along(p.y())}; }

  /// Far out (or not a number) everything shares the last cell: slower, never wrong.
  std::int64_t along(double x) const {
    constexpr double kFar = 1e9;
    const double c = x * per_m_;
    if (!(c > -kFar)) return static_cast<std::int64_t>(-kFar);
    if (c > kFar) return static_cast<std::int64_t>(kFar);
    const auto towards_zero = static_cast<std::int64_t>(c);
    return towards_zero - (static_cast<double>(towards_zero) > c ? 1 : 0);
  }

  std::uint32_t bucket_of(const Cell& cell) const {
    std::uint64_t h = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15ull;
    h ^= static_cast<std::uint64_t>(cell.y) * 0xC2B2AE3D27D4EB4Full;
    return static_cast<std::uint32_t>(h ^ (h >> 29)) & mask_;
  }

  template <class Visit>
  void visit_column(std::uint32_t bucket, const Cell& cell, double low, double high, Visit& visit) const {
    for (std::uint32_t i = starts_[bucket]; i < starts_[bucket + 1]; ++i) {
      if (is_within(sorted_[i], cell, low, high)) visit(sorted_[i].index);
    }
  }

  template <class Visit>
  void visit_late(std::uint32_t bucket, const Cell& cell, double low, double high, Visit& visit) const {
    for (std::uint32_t i = late_heads_[bucket]; i != kNone; i = late_[i].next) {
      if (is_within(late_[i].point, cell, low, high)) visit(late_[i].point.index);
    }
  }

  /// Written so that a height that is not a number is visited: slower, never wrong.
  static bool is_within(const Point& point, const Cell& cell, double low, double high) {
    return point.cell == cell && !(point.z < low) && !(point.z > high);
  }

  double per_m_ = 1;  ///< columns per metre
  std::uint32_t mask_ = 0;
  std::vector<Point> points_;
  std::vector<Point> sorted_;
  std::vector<std::uint32_t> starts_;
  std::vector<Late> late_;
  std::vector<std::uint32_t> late_heads_;  ///< by bucket, once there is any
};

}  // namespace aurasim::core
