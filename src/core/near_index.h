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
  /// `fast_range_m` (fast ones) of the sphere of `radius_m` around `p`. Some are visited twice.
  template <class Visit>
  void for_each_near(const Vec3& p, double radius_m, double slow_range_m, double fast_range_m, Visit&& visit) const {
    for_each_near(
        p, radius_m, slow_range_m, fast_range_m, [](std::uint32_t) { return false; }, visit);
  }

  /// The same without the groups of bodies for which `skip(group)` is true.
  template <class Skip, class Visit>
  void for_each_near(const Vec3& p, double radius_m, double slow_range_m, double fast_range_m, Skip&& skip,
                     Visit&& visit) const {
    const Vec3 slow = Vec3::Constant(radius_m + slow_range_m + small_radius_);
    slow_.for_each_in(p - slow, p + slow, skip, visit);
    const Vec3 fast = Vec3::Constant(radius_m + fast_range_m + small_radius_);
    const auto skip_fast = [&](std::uint32_t group) { return skip(slow_.group_count() + group); };
    if (!fast_.empty()) fast_.for_each_in(p - fast, p + fast, skip_fast, visit);
    for (const std::uint32_t i : always_) visit(i);
  }

  /// Groups are neighbours in space, the same from build() to build().
  std::uint32_t group_count() const { return slow_.group_count() + fast_.group_count(); }
  template <class Holds>
  bool all_of(std::uint32_t group, Holds&& holds) const {
    const std::uint32_t slow_groups = slow_.group_count();
    return group < slow_groups ? slow_.all_of(group, holds) : fast_.all_of(group - slow_groups, holds);
  }
  std::uint32_t any_of(std::uint32_t group) const {
    const std::uint32_t slow_groups = slow_.group_count();
    return group < slow_groups ? slow_.any_of(group) : fast_.any_of(group - slow_groups);
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
