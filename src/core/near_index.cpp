#include "core/near_index.h"

namespace aurasim::core {

void NearIndex::build(std::span<const Path> paths) {
  double sum = 0;
  top_speed_ = top_radius_ = small_radius_ = 0;
  for (const Path& path : paths) sum += path.radius_m;
  const double mean = paths.empty() ? 1 : sum / static_cast<double>(paths.size());
  const double large = 4 * mean;
  const double cell = std::max(2 * mean, 1e-3);
  for (Gear& gear : gears_) {
    gear.grid.clear(&gear == &gears_.front() ? cell : 2 * cell);
    gear.top_m_s = 0;
  }
  always_.clear();
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    top_speed_ = std::max(top_speed_, paths[i].speed_m_s);
    top_radius_ = std::max(top_radius_, paths[i].radius_m);
    if (paths[i].radius_m > large) {
      always_.push_back(i);
      continue;
    }
    small_radius_ = std::max(small_radius_, paths[i].radius_m);
    Gear& gear = gears_[gear_of(paths[i].speed_m_s)];
    gear.top_m_s = std::max(gear.top_m_s, paths[i].speed_m_s);
    gear.grid.add(i, paths[i].pose.p_WB);
  }
  for (Gear& gear : gears_) gear.grid.build(paths.size());
}

}  // namespace aurasim::core
