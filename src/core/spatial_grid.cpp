#include "core/spatial_grid.h"

#include <algorithm>
#include <bit>

namespace aurasim::core {

void SpatialGrid::clear(double cell_m) {
  per_m_ = 1 / cell_m;
  points_.clear();
  late_.clear();
}

void SpatialGrid::add(std::uint32_t index, const Vec3& p) { points_.push_back({cell_of(p), p.z(), index, 0}); }

void SpatialGrid::build() {
  const auto buckets = std::bit_ceil(std::max<std::uint32_t>(16, 2 * static_cast<std::uint32_t>(points_.size())));
  mask_ = buckets - 1;
  starts_.assign(buckets + 1, 0);
  for (Point& point : points_) {
    point.bucket = bucket_of(point.cell);
    ++starts_[point.bucket + 1];
  }
  for (std::uint32_t b = 0; b < buckets; ++b) starts_[b + 1] += starts_[b];
  sorted_.resize(points_.size());
  for (auto point = points_.rbegin(); point != points_.rend(); ++point) {
    sorted_[--starts_[point->bucket + 1]] = *point;  // leaves starts_[b + 1] at the start of bucket b
  }
  for (std::uint32_t b = 0; b < buckets; ++b) starts_[b] = starts_[b + 1];
  starts_[buckets] = static_cast<std::uint32_t>(points_.size());
}

void SpatialGrid::insert(std::uint32_t index, const Vec3& p) {
  if (late_.empty()) late_heads_.assign(group_count(), kNone);
  const Cell cell = cell_of(p);
  const std::uint32_t bucket = bucket_of(cell);
  late_.push_back({{cell, p.z(), index, bucket}, late_heads_[bucket]});
  late_heads_[bucket] = static_cast<std::uint32_t>(late_.size() - 1);
}

}  // namespace aurasim::core
