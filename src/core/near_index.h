// Finds bodies near a place. Slow, faster and very large bodies are indexed apart, so that one fast or one large body
// does not widen every query.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/spatial_grid.h"

namespace aurasim::core {

class NearIndex {
 public:
  /// Bodies that state no higher speed than this are slow (m/s).
  static constexpr double kSlow = 3.0;

  /// Indexes `paths` by their speed_m_s.
  void build(std::span<const Path> paths);
  /// The same for those of the paths that `some` names.
  void build(std::span<const Path> paths, std::span<const std::uint32_t> some);

  double top_speed() const { return top_speed_; }
  double top_radius() const { return top_radius_; }

  /// Calls `visit(index)` for at least every body whose bounding sphere comes within `range_at(its speed)` of the box
  /// [lo, hi]. `range_at` gives metres for m/s and must not fall as the speed grows.
  template <class RangeAt, class Visit>
  void for_each_near(const Vec3& lo, const Vec3& hi, RangeAt&& range_at, Visit&& visit) const {
    for (const Gear& gear : gears_) {
      if (gear.grid.empty()) continue;
      const Vec3 range = Vec3::Constant(range_at(gear.top_m_s) + small_radius_);
      gear.grid.for_each_in(lo - range, hi + range, visit);
    }
    for (const std::uint32_t i : always_) visit(i);
  }

  /// Like the other overload, for the sphere of `radius_m` around `p`.
  template <class RangeAt, class Visit>
  void for_each_near(const Vec3& p, double radius_m, RangeAt&& range_at, Visit&& visit) const {
    const Vec3 half = Vec3::Constant(radius_m);
    for_each_near(p - half, p + half, range_at, visit);
  }

 private:
  /// Bodies of one range of speeds.
  struct Gear {
    SpatialGrid grid;
    double top_m_s = 0;  ///< the fastest of them
  };
  static constexpr std::array kFastestOfGear = {kSlow, 2 * kSlow, 4 * kSlow, std::numeric_limits<double>::infinity()};

  static std::size_t gear_of(double speed_m_s) {
    std::size_t gear = 0;
    while (speed_m_s > kFastestOfGear[gear]) ++gear;
    return gear;
  }

  void begin(double sum_of_radii_m, std::size_t count);
  void add(std::uint32_t index, const Path& path);

  std::array<Gear, kFastestOfGear.size()> gears_;
  std::vector<std::uint32_t> always_;  ///< large bodies, visited in every query
  double large_radius_ = 0;            ///< bodies with a larger radius are large
  double small_radius_ = 0;            ///< largest radius of the bodies in the grids
  double top_speed_ = 0;
  double top_radius_ = 0;
};

}  // namespace aurasim::core
