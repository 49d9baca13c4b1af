#include "core/pushes.h"

#include <algorithm>

namespace aurasim::core {

Push Push::of(double speed_m_s, const BodyTraits& traits, double uncertainty) {
  const double share = (1 + traits.restitution) / std::clamp(uncertainty, 0.1, 1.0);
  return {speed_m_s, share * traits.mass_kg * speed_m_s, std::max(0.0, share - 1) * traits.mass_kg};
}

// One over the speed is zero or linear in the mass that is dragged along, on either side of free_kg. This one's is
// convex, so where it is not above the other's at both ends of a piece on which that is linear, it is nowhere above.
bool Push::covers(const Push& other) const {
  constexpr double kNearly = 1 - 1e-9;  // so that rounding does not make news of what is known
  if (other.speed_m_s <= kUnfelt_m_s) return true;
  if (speed_m_s < kNearly * other.speed_m_s) return false;
  if (momentum_kg_m_s >= other.momentum_kg_m_s && free_kg >= other.free_kg) return true;
  if (speed_with(other.free_kg) < kNearly * other.speed_m_s) return false;
  const double unfelt_kg = other.free_kg + other.momentum_kg_m_s * (1 / kUnfelt_m_s - 1 / other.speed_m_s);
  return speed_with(unfelt_kg) >= kNearly * kUnfelt_m_s;
}

Push Push::joined_with(const Push& other) const {
  Push both{std::max(speed_m_s, other.speed_m_s), std::max(momentum_kg_m_s, other.momentum_kg_m_s), 0};
  for (const Push& push : {*this, other}) {
    if (push.speed_m_s <= 0) continue;
    both.free_kg =
        std::max(both.free_kg, push.free_kg - both.momentum_kg_m_s * (1 / push.speed_m_s - 1 / both.speed_m_s));
  }
  return both;
}

void Pushes::begin(std::span<const double> own_m_s, std::span<const BodyTraits> traits, double uncertainty) {
  const auto n = own_m_s.size();
  pushes_.resize(n);
  inert_kg_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    pushes_[i] = Push::of(own_m_s[i], traits[i], uncertainty);
    inert_kg_[i] = (1 - traits[i].restitution) * traits[i].mass_kg;
  }
  first_link_.assign(n, kNone);
  links_.clear();
}

void Pushes::add(std::uint32_t a, std::uint32_t b, bool rigid) {
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
    links_.push_back({to, first_link_[from], rigid});
    first_link_[from] = static_cast<std::uint32_t>(links_.size() - 1);
  }
}

void Pushes::start(std::uint32_t i) {
  if (speed(i) <= Push::kUnfelt_m_s) return;
  for (std::uint32_t at = first_link_[i]; at != kNone; at = links_[at].next) {
    if (pushes_[links_[at].to].covers(along(i, links_[at]))) continue;
    to_do_.emplace(speed(i), i);
    return;
  }
}

void Pushes::spread(std::vector<std::uint32_t>& raised) {
  while (!to_do_.empty()) {
    const auto [speed, i] = to_do_.top();
    to_do_.pop();
    if (speed < pushes_[i].speed_m_s) continue;  // it has become faster since, and is there again
    for (std::uint32_t at = first_link_[i]; at != kNone; at = links_[at].next) {
      const std::uint32_t to = links_[at].to;
      Push& known = pushes_[to];
      const Push coming = along(i, links_[at]);
      if (known.covers(coming)) continue;
      const double before = known.speed_m_s;
      known = known.joined_with(coming);
      if (known.speed_m_s > before) raised.push_back(to);
      to_do_.emplace(known.speed_m_s, to);
    }
  }
}

}  // namespace aurasim::core
