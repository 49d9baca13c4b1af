// To whom the aura of a body goes (docs/design.md, "To whom an aura goes").
#include <algorithm>
#include <bit>

#include "core/horizon.h"
#include "core/interest_matching.h"

namespace aurasim::core {
namespace {

/// The rectangle below the way from `p` to `q`.
Rectangle box_of(const Vec3& p, const Vec3& q) {
  return {std::min(p.x(), q.x()), std::min(p.y(), q.y()), std::max(p.x(), q.x()), std::max(p.y(), q.y())};
}

}  // namespace

/// Is `p` outside our region, where nobody compares what others host there? The owner of the place does, if it checks
/// states and is alive.
bool InterestMatching::is_out_alone(const Vec3& p) const {
  if (vicinity_.home().contains(p.x(), p.y())) return false;
  return !aura_.rules().redo || !std::ranges::binary_search(live_, vicinity_.map.owner(p));
}

double InterestMatching::band(double speed_m_s, int hops) const {
  return aura_.zone(speed_m_s, hops, std::max(others_top_speed_, speed_m_s), others_top_radius_);
}

/// Looks at the places of our bodies near the border: who has to know of them, and which are outside.
void InterestMatching::find_zones() {
  outside_.clear();
  own_.find_close(std::max(0.0, band(top_speed(), aura_.rules().most_hops() + homeward_hops())));
  for (const std::uint32_t i : own_.close()) {
    const Audience zone = zone_of(i);
    audiences_[i] |= is_out_alone(own_.path(i).pose.p_WB) ? kAllListeners : zone;
    if (outside(i)) outside_.push_back(i);
  }
}

/// The owners of territory within the zone of body i. Where states are not checked, the body looks as many hops ahead
/// as there are such owners, and its zone grows with its hops.
Audience InterestMatching::zone_of(std::uint32_t i) {
  const Path& path = own_.path(i);
  const Vec3& p = path.pose.p_WB;
  const AuraRules& rules = aura_.rules();
  if (!rules.redo || !aura_.predicts()) {
    for (;; ++hops_[i]) {
      const Audience near = vicinity_.within(p, band(path.speed_m_s, hops_[i] + homeward_hops()) + path.radius_m);
      if (std::min(std::popcount(near), rules.most_hops()) <= hops_[i]) return near;
    }
  }
  // Where states are checked the body is believed to keep to its path, and to leave it by U times its speed.
  const Vec3 ahead = p + path.v_WB * (horizon::announcing(rules.lookahead, 1) * rules.step_s);
  const double u = rules.uncertainty;
  const double zone =
      aura_.zone(u / (1 + u) * path.speed_m_s, 1, std::max(others_top_speed_, path.speed_m_s), others_top_radius_);
  return vicinity_.within(box_of(p, ahead), zone + path.radius_m);
}

bool InterestMatching::outside(std::uint32_t i) const {
  const Vec3& p = own_.path(i).pose.p_WB;
  if (!aura_.warns()) return !vicinity_.home().contains(p.x(), p.y());
  return vicinity_.home().distance(p.x(), p.y()) > own_.path(i).radius_m;
}

}  // namespace aurasim::core
