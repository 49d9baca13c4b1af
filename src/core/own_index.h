// Finds our bodies near a place. Those at rest are in an index of their own, which is built anew only now and then: a
// body that moves leaves it, and counts as moving until then.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/near_index.h"

namespace aurasim::core {

class OwnIndex {
 public:
  /// Indexes all paths.
  void build(std::span<const Path> paths);
  /// Indexes the paths again, of which only those that `changed` names differ from before.
  void renew(std::span<const Path> paths, std::span<const std::uint32_t> changed);

  double top_speed() const { return std::max(moving_.top_speed(), resting_.top_speed()); }
  double top_radius() const { return std::max(moving_.top_radius(), resting_.top_radius()); }

  /// See NearIndex.
  template <class RangeAt, class Visit>
  void for_each_near(const Vec3& lo, const Vec3& hi, RangeAt&& range_at, Visit&& visit) const {
    moving_.for_each_near(lo, hi, range_at, visit);
    resting_.for_each_near(lo, hi, range_at, [&](std::uint32_t i) {
      if (!is_moving_[i]) visit(i);
    });
  }
  template <class RangeAt, class Visit>
  void for_each_near(const Vec3& p, double radius_m, RangeAt&& range_at, Visit&& visit) const {
    const Vec3 half = Vec3::Constant(radius_m);
    for_each_near(p - half, p + half, range_at, visit);
  }

 private:
  void index_resting(std::span<const Path> paths);

  NearIndex moving_, resting_;
  std::vector<std::uint32_t> movers_;    ///< bodies of moving_
  std::vector<std::uint8_t> is_moving_;  ///< by body
  std::vector<std::uint32_t> rest_;      ///< memory for the bodies of resting_
};

}  // namespace aurasim::core
