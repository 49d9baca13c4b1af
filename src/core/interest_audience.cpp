// To whom the aura of a body goes (docs/design.md, "To whom an aura goes").
#include <algorithm>

#include "core/horizon.h"
#include "core/interest_matching.h"

namespace aurasim::core {
namespace {

/// The rectangle below the way from `p` to `q`.
Rectangle box_of(const Vec3& p, const Vec3& q) {
  return {std::min(p.x(), q.x()), std::min(p.y(), q.y()), std::max(p.x(), q.x()), std::max(p.y(), q.y())};
}

}  // namespace

Audience InterestMatching::audience(std::uint32_t i) const {
  if (announced_to_all_[i] || is_out_alone(own_.path(i).pose.p_WB)) return kAllListeners;
  const Audience near = noticed_by_[i] | owners_in_zone(i);
  return near != kNobodyListens && has_narrow_regions_ ? kAllListeners : near;
}

/// Is `p` outside our region, where nobody compares what others host there? The owner of the place does, if it checks
/// states and is alive.
bool InterestMatching::is_out_alone(const Vec3& p) const {
  if (vicinity_.home().contains(p.x(), p.y())) return false;
  return !aura_.rules().redo || !std::ranges::binary_search(live_, vicinity_.map.owner(p));
}

double InterestMatching::band(double speed_m_s, int hops) const {
  return aura_.zone(speed_m_s, hops, std::max(others_top_speed_, speed_m_s), others_top_radius_);
}

/// Where pulls do not chain, zones do not depend on clusters. So they are known before bodies are compared.
void InterestMatching::find_zones() {
  widest_band_m_ = band(top_speed(), clusters_.most_hops() + homeward_hops());
  for (const std::uint32_t i : own_.close()) zones_[i] = zone_of(i);
}

/// The owners of territory within the zone of body i.
Audience InterestMatching::zone_of(std::uint32_t i) const {
  const Path& path = own_.path(i);
  const Vec3& p = path.pose.p_WB;
  if (vicinity_.deep_inside(p, widest_band_m_ + path.radius_m)) return kNobodyListens;
  const int hops = clusters_.hops(i) + homeward_hops();
  if (!aura_.rules().redo || !aura_.predicts()) {
    return vicinity_.within(p, band(path.speed_m_s, hops) + path.radius_m);
  }
  // Where states are checked the body is believed to keep to its path, and to leave it by U times its speed.
  const Vec3 ahead = p + path.v_WB * (horizon::announcing(aura_.rules().lookahead, hops) * aura_.rules().step_s);
  const double u = aura_.rules().uncertainty;
  const double zone =
      aura_.zone(u / (1 + u) * path.speed_m_s, hops, std::max(others_top_speed_, path.speed_m_s), others_top_radius_);
  return vicinity_.within(box_of(p, ahead), zone + path.radius_m);
}

bool InterestMatching::outside(std::uint32_t i) const {
  const Vec3& p = own_.path(i).pose.p_WB;
  if (!aura_.warns()) return !vicinity_.home().contains(p.x(), p.y());
  return vicinity_.home().distance(p.x(), p.y()) > own_.path(i).radius_m;
}

}  // namespace aurasim::core
