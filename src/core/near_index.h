// Which of a node's own bodies are near a place? Slow bodies, fast bodies and very large ones are kept apart, so that
// one fast or one large body does not widen every query.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/spatial_grid.h"

namespace aurasim::core {

class NearIndex {
 public:
  /// Bodies that can become no faster than this are slow (m/s).
  static constexpr double kSlow = 3.0;

  /// Indexes `paths`, with their speeds as far as they are known.
  void build(std::span<const Path> paths);

  /// Body `i` at `p` turned out to be faster.
  void raise(std::uint32_t i, const Vec3& p, double before_m_s, double now_m_s) {
    top_speed_ = std::max(top_speed_, now_m_s);
    if (before_m_s <= kSlow && now_m_s > kSlow) fast_.insert(i, p);
  }

  double top_speed() const { return top_speed_; }
  double top_radius() const { return top_radius_; }

  /// Calls `visit(index)` for at least every body whose bounding sphere comes within `slow_range_m` (slow bodies) or
  /// `fast_range_m` (fast ones) of the box [lo, hi]. Some are visited twice.
  template <class Visit>
  void for_each_near(const Vec3& lo, const Vec3& hi, double slow_range_m, double fast_range_m, Visit&& visit) const {
    const Vec3 slow = Vec3::Constant(slow_range_m + small_radius_);
    slow_.for_each_in(lo - slow, hi + slow, visit);
    const Vec3 fast = Vec3::Constant(fast_range_m + small_radius_);
    fast_.for_each_in(lo - fast, hi + fast, visit);
    for (const std::uint32_t i : always_) visit(i);
  }

  /// The same for the sphere of `radius_m` around `p`.
  template <class Visit>
  void for_each_near(const Vec3& p, double radius_m, double slow_range_m, double fast_range_m, Visit&& visit) const {
    const Vec3 half = Vec3::Constant(radius_m);
    for_each_near(p - half, p + half, slow_range_m, fast_range_m, visit);
  }

 private:
  SpatialGrid slow_;
  SpatialGrid fast_;
  std::vector<std::uint32_t> always_;  ///< large
  double small_radius_ = 0;            ///< largest radius of the bodies in the grids
  double top_speed_ = 0;
  double top_radius_ = 0;
};

}  // namespace aurasim::core
