#include "core/near_index.h"

namespace aurasim::core {

void NearIndex::build(std::span<const Path> paths) {
  double sum = 0;
  for (const Path& path : paths) sum += path.radius_m;
  begin(sum, paths.size());
  for (std::uint32_t i = 0; i < paths.size(); ++i) add(i, paths[i]);
  for (Gear& gear : gears_) gear.grid.build(paths.size());
}

void NearIndex::build(std::span<const Path> paths, std::span<const std::uint32_t> some) {
  double sum = 0;
  for (const std::uint32_t i : some) sum += paths[i].radius_m;
  begin(sum, some.size());
  for (const std::uint32_t i : some) add(i, paths[i]);
  for (Gear& gear : gears_) gear.grid.build();
}

void NearIndex::begin(double sum_of_radii_m, std::size_t count) {
  top_speed_ = top_radius_ = small_radius_ = 0;
  const double mean = count == 0 ? 1 : sum_of_radii_m / static_cast<double>(count);
  large_radius_ = 4 * mean;
  const double cell = std::max(2 * mean, 1e-3);
  for (Gear& gear : gears_) {
    gear.grid.clear(&gear == &gears_.front() ? cell : 2 * cell);
    gear.top_m_s = 0;
  }
  always_.clear();
}

void NearIndex::add(std::uint32_t index, const Path& path) {
  top_speed_ = std::max(top_speed_, path.speed_m_s);
  top_radius_ = std::max(top_radius_, path.radius_m);
  if (path.radius_m > large_radius_) return always_.push_back(index);
  small_radius_ = std::max(small_radius_, path.radius_m);
  Gear& gear = gears_[gear_of(path.speed_m_s)];
  gear.top_m_s = std::max(gear.top_m_s, path.speed_m_s);
  gear.grid.add(index, path.pose.p_WB);
}

}  // namespace aurasim::core
