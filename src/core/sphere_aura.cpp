#include "core/sphere_aura.h"

#include <cmath>

namespace aurasim::core {

bool SphereAura::spheres_within(const Path& a, const Path& b, double distance_m) const {
  const double d = a.radius_m + b.radius_m + rules().contact_margin_m + a.blur_m + b.blur_m + distance_m;
  return (a.pose.p_WB - b.pose.p_WB).squaredNorm() <= d * d;
}

bool SphereAura::meets(const Path& foreign, const Path& own, int hops, int) const {
  return spheres_within(foreign, own, reach(hops));
}

bool SphereAura::linked(const Path& a, const Path& b, int hops) const {
  return spheres_within(a, b, cluster_reach(hops));
}

/// Until its new host's first aura has come, it is guarded like one of ours.
bool SphereAura::meets_ghost(const Path& ghost, const Path& own, int hops, int) const {
  return linked(ghost, own, hops);
}

Aura::Steps SphereAura::steps(Question question, int hops) const {
  switch (question) {
    case Question::kZone:
      return meeting_steps(hops);
    case Question::kNotice:
      return notice_steps(hops);
    case Question::kMeeting:  // also with ghosts
      return reach(hops) > cluster_reach(hops) ? meeting_steps(hops) : link_steps(hops);
    case Question::kLink:
      break;
  }
  return link_steps(hops);
}

Range SphereAura::span(double steps) const {
  return {rules().reach_scale * steps * rules().step_s * rules().top_speed_m_s, 0};
}

/// With S instants in a step at which contacts may be found the last (S-1)/S of a step counts, for both bodies; so does
/// every further hop that a pull can chain through.
Aura::Steps TightAura::chained(double own, double other, int hops) const {
  const double more = 1.0 * (rules().instants() - 1) / rules().instants() + 1.0 * (hops - 1) * rules().lookahead;
  return {own + more, other + more};
}

/// Found when it is K states old, acted upon K states later, except for the state of the last look, which was clear.
Aura::Steps TightAura::meeting_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(k - 1, 2 * k - 1, hops);
}

/// It was seen K steps late, and its host needs K more.
Aura::Steps TightAura::notice_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(2 * k - 1, 3 * k - 1, hops);
}

/// Both go the way of a foreign body that meets one of ours.
Aura::Steps TightAura::link_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(2 * k - 1, 2 * k - 2, hops);
}

Aura::Steps ThesisAura::meeting_steps(int) const {
  return {3 * std::ceil((2 * rules().frame_s + rules().latency_s) / rules().step_s) - 1, 0};
}

}  // namespace aurasim::core
