// A quick answer to "is any of these spheres near that one?", which is yes too often and never no too often. The
// world is divided into square vertical columns. A bit for each column is set if a sphere reaches into it. Columns
// share bits.
#pragma once

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>

#include "core/body_state.h"

namespace aurasim::core {

class CoveredColumns {
 public:
  /// Forgets all spheres and sets the side of the columns, metres, above 0.
  void clear(double side_m) {
    per_m_ = 1 / side_m;
    covered_.reset();
  }

  void add(const Vec3& middle, double radius_m) {
    if (!visit(middle, radius_m, [this](std::uint64_t column) {
          covered_.set(column);
          return true;
        })) {
      covered_.set();
    }
  }

  /// True if a sphere that was added may touch this one.
  bool may_meet(const Vec3& middle, double radius_m) const {
    return !visit(middle, radius_m, [this](std::uint64_t column) { return !covered_.test(column); });
  }

 private:
  static constexpr std::uint64_t kColumns = 1U << 15U;
  /// A sphere that is wider than so many columns counts as being everywhere.
  static constexpr double kMostAcross = 32;

  /// Calls `go_on(column)` for each column of a sphere, until it returns false. Returns false then, and for spheres
  /// that count as being everywhere.
  template <class GoOn>
  bool visit(const Vec3& middle, double radius_m, GoOn&& go_on) const {
    const double x = middle.x() * per_m_, y = middle.y() * per_m_, r = radius_m * per_m_;
    constexpr double kFar = 1e9;
    if (!(2 * r < kMostAcross) || !(std::abs(x) < kFar) || !(std::abs(y) < kFar)) return false;
    const auto last_x = static_cast<std::int64_t>(std::floor(x + r)),
               last_y = static_cast<std::int64_t>(std::floor(y + r));
    const auto first_y = static_cast<std::int64_t>(std::floor(y - r));
    for (auto column_x = static_cast<std::int64_t>(std::floor(x - r)); column_x <= last_x; ++column_x) {
      for (std::int64_t column_y = first_y; column_y <= last_y; ++column_y) {
        const std::uint64_t row = (static_cast<std::uint64_t>(column_x) * 0x9E3779B97F4A7C15ull) >> 32U;
        if (!go_on((row + static_cast<std::uint64_t>(column_y)) % kColumns)) return false;
      }
    }
    return true;
  }

  double per_m_ = 1;
  std::bitset<kColumns> covered_;
};

}  // namespace aurasim::core
