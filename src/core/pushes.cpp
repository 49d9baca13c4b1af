#include "core/pushes.h"

#include <algorithm>

namespace aurasim::core {

Push Push::of(double speed_m_s, const BodyTraits& traits, double uncertainty) {
  const double most_m_s = (1 + traits.restitution) / std::clamp(uncertainty, 0.1, 1.0) * speed_m_s;
  return {most_m_s, traits.mass_kg * most_m_s};
}

// One over the speed is linear in the mass that is dragged along: who is not slower at both ends is nowhere slower.
bool Push::covers(const Push& other) const {
  constexpr double kNearly = 1 - 1e-9;  // so that rounding does not make news of what is known
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
  group_.assign(n, kNone);
  groups_.resize(n);
}

void Pushes::add(std::uint32_t a, std::uint32_t b, bool rigid) {
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
    links_.push_back({to, first_link_[from], rigid});
    first_link_[from] = static_cast<std::uint32_t>(links_.size() - 1);
  }
}

std::uint32_t Pushes::group_of(std::uint32_t i) {
  while (group_[i] != i) i = group_[i] = group_[group_[i]];
  return i;
}

/// Whoever touches body i, itself or through others, and is at least half as fast pushes on when i hits something.
void Pushes::form_moving_groups(std::span<std::uint32_t> members) {
  std::sort(members.begin(), members.end(), [&](auto a, auto b) { return own_m_s_[a] > own_m_s_[b]; });
  const auto unfelt =
      std::find_if(members.begin(), members.end(), [&](auto i) { return own_m_s_[i] <= Push::kUnfelt_m_s; });
  auto next = members.begin();
  for (const std::uint32_t i : std::span(members.begin(), unfelt)) {
    if (first_link_[i] == kNone) continue;
    for (; next != unfelt && own_m_s_[*next] >= 0.5 * own_m_s_[i]; ++next) {
      group_[*next] = *next;
      const double kg = traits_[*next].mass_kg;
      groups_[*next] = {kg, kg * own_m_s_[*next]};
      for (std::uint32_t at = first_link_[*next]; at != kNone; at = links_[at].next) {
        if (group_[links_[at].to] == kNone) continue;
        const std::uint32_t a = group_of(*next), b = group_of(links_[at].to);
        if (a == b) continue;
        group_[b] = a;
        groups_[a].kg += groups_[b].kg;
        groups_[a].kg_m_s += groups_[b].kg_m_s;
      }
    }
    const double share = own_[i].speed_m_s / own_m_s_[i];
    const MovingGroup& group = groups_[group_of(i)];
    own_[i] = {share * std::max(own_m_s_[i], group.kg_m_s / group.kg), share * group.kg_m_s};
  }
}

std::optional<Push> Pushes::pushed(std::uint32_t i) const {
  const Push by_itself = alone(i);
  const Push all = by_itself.covers(own_[i]) ? received_[i] : received_[i].joined_with(own_[i]);
  if (all.speed_m_s <= by_itself.speed_m_s && by_itself.covers(all)) return std::nullopt;
  return all;
}

void Pushes::start(std::uint32_t i) {
  if (speed(i) <= Push::kUnfelt_m_s) return;
  for (std::uint32_t at = first_link_[i]; at != kNone; at = links_[at].next) {
    if (received_[links_[at].to].covers(along(i, links_[at]))) continue;
    to_do_.emplace(speed(i), i);
    return;
  }
}

bool Pushes::hit(std::uint32_t i, const Impact& impact) {
  if (!feels(impact, i)) return false;
  received_[i] = received_[i].joined_with(impact.on(traits_[i]));
  start(i);
  return true;
}

void Pushes::spread(std::vector<std::uint32_t>& raised) {
  while (!to_do_.empty()) {
    const auto [fast_m_s, i] = to_do_.top();
    to_do_.pop();
    if (fast_m_s < speed(i)) continue;  // it has become faster since, and is there again
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
