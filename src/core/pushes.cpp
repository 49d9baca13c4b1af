#include "core/pushes.h"

#include <algorithm>

#include "core/progress.h"

namespace aurasim::core {

Push Push::of(double speed_m_s, const BodyTraits& traits, double uncertainty) {
  const double most_m_s = (1 + traits.restitution) / std::clamp(uncertainty, 0.1, 1.0) * speed_m_s;
  return {most_m_s, traits.mass_kg * most_m_s};
}

// 1 / speed is linear in the dragged mass. So a push that is not slower at both ends of the range of masses is nowhere
// slower.
bool Push::covers(const Push& other) const {
  constexpr double kNearly = 1 - 1e-9;  // so that rounding does not count as a change
  if (other.speed_m_s <= kUnfelt_m_s) return true;
  if (speed_m_s < kNearly * other.speed_m_s) return false;
  if (momentum_kg_m_s >= kNearly * other.momentum_kg_m_s) return true;
  const double unfelt_kg = other.momentum_kg_m_s * (1 / kUnfelt_m_s - 1 / other.speed_m_s);
  return speed_with(unfelt_kg) >= kNearly * kUnfelt_m_s;
}

void Pushes::begin(std::span<const double> own_m_s, std::span<const BodyTraits> traits, double uncertainty) {
  const auto n = own_m_s.size();
  uncertainty_ = uncertainty;
  own_m_s_.assign(own_m_s.begin(), own_m_s.end());
  traits_ = traits;
  received_.assign(n, {});
  own_.resize(n);
  lightest_ = {};
  for (std::size_t i = 0; i < n; ++i) {
    own_[i] = Push::of(own_m_s[i], traits[i], uncertainty);
    lightest_.mass_kg = i == 0 ? traits[i].mass_kg : std::min(lightest_.mass_kg, traits[i].mass_kg);
    lightest_.restitution = i == 0 ? traits[i].restitution : std::max(lightest_.restitution, traits[i].restitution);
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
    if (received_[links_[at].to].covers(along(i, links_[at]))) continue;
    to_do_.emplace(speed(i), i);
    return;
  }
}

void Pushes::spread(std::vector<std::uint32_t>& raised) {
  while (!to_do_.empty()) {
    const auto [fast_m_s, i] = to_do_.top();
    to_do_.pop();
    Progress::mark();
    if (fast_m_s < speed(i)) continue;  // outdated: the body became faster and is in the queue again
    for (std::uint32_t at = first_link_[i]; at != kNone; at = links_[at].next) {
      const std::uint32_t to = links_[at].to;
      const Push coming = along(i, links_[at]);
      if (received_[to].covers(coming)) continue;
      const double before = speed(to);
      received_[to] = received_[to].joined_with(coming);
      if (speed(to) > before) raised.push_back(to);
      to_do_.emplace(speed(to), to);
    }
  }
}

}  // namespace aurasim::core
