#include "core/spatial_grid.h"

#include <bit>

namespace aurasim::core {

void SpatialGrid::clear(double cell_m) {
  per_m_ = 1 / cell_m;
  points_.clear();
}

void SpatialGrid::add(std::uint32_t index, const Vec3& p) {
  points_.push_back({p.x(), p.y(), p.z(), static_cast<std::int32_t>(along(p.x())), index});
}

void SpatialGrid::build(std::size_t most) {
  const auto points = static_cast<std::uint32_t>(std::max(most, points_.size()));
  const auto buckets = std::bit_ceil(std::max<std::uint32_t>(16, 2 * points));
  mask_ = buckets - 1;
  starts_.assign(buckets + 1, 0);
  buckets_.clear();
  for (const Point& point : points_) {
    buckets_.push_back(bucket_of(point));
    ++starts_[buckets_.back() + 1];
  }
  for (std::uint32_t b = 0; b < buckets; ++b) starts_[b + 1] += starts_[b];
  sorted_.resize(points_.size());
  for (std::size_t i = points_.size(); i-- > 0;) {
    sorted_[--starts_[buckets_[i] + 1]] = points_[i];  // leaves starts_[b + 1] at the start of bucket b
  }
  for (std::uint32_t b = 0; b < buckets; ++b) starts_[b] = starts_[b + 1];
  starts_[buckets] = static_cast<std::uint32_t>(points_.size());
}

}  // namespace aurasim::core
