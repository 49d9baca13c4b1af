#include "core/sphere_aura.h"

#include <cmath>

namespace aurasim::core {

bool SphereAura::spheres_within(const Path& a, const Path& b, double distance_m) const {
  const double d = a.radius_m + b.radius_m + rules().contact_margin_m + a.blur_m + b.blur_m + distance_m;
  return (a.pose.p_WB - b.pose.p_WB).squaredNorm() <= d * d;
}

bool SphereAura::meets(const Path& foreign, const Path& own, int hops) const {
  return spheres_within(foreign, own, reach(hops));
}

bool SphereAura::linked(const Path& a, const Path& b, int hops) const {
  return spheres_within(a, b, cluster_reach(hops));
}

/// A ghost counts like one of our bodies until the first aura of its new host has arrived.
bool SphereAura::meets_ghost(const Path& ghost, const Path& own, int hops) const { return linked(ghost, own, hops); }

Aura::Steps SphereAura::steps(Question question, int hops) const {
  switch (question) {
    case Question::kZone:
      return meeting_steps(hops);
    case Question::kNotice:
      return notice_steps(hops);
    case Question::kMeeting:  // also covers ghosts, which use the distance of links
      return reach(hops) > cluster_reach(hops) ? meeting_steps(hops) : link_steps(hops);
    case Question::kLink:
      break;
  }
  return link_steps(hops);
}

Range SphereAura::span(double steps) const {
  return {rules().reach_scale * steps * rules().step_s * rules().top_speed_m_s, 0};
}

/// Adds to both bodies' steps the last (S-1)/S of a step, for S instants at which contacts may be found, and K for
/// every hop beyond the first.
Aura::Steps TightAura::chained(double own, double other, int hops) const {
  const double more = 1.0 * (rules().instants() - 1) / rules().instants() + 1.0 * (hops - 1) * rules().lookahead;
  return {own + more, other + more};
}

/// The foreign body is seen when its state is K steps old, and the hand-off takes effect K steps later. One step less,
/// because the last look found nothing.
Aura::Steps TightAura::meeting_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(k - 1, 2 * k - 1, hops);
}

/// The other node sees our body K steps late, and its host needs K more than for a meeting.
Aura::Steps TightAura::notice_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(2 * k - 1, 3 * k - 1, hops);
}

/// Steps in which two own bodies may come together: each may move for as long as a foreign body before it meets an own
/// one.
Aura::Steps TightAura::link_steps(int hops) const {
  const int k = rules().lookahead;
  return chained(2 * k - 1, 2 * k - 2, hops);
}

Aura::Steps ThesisAura::meeting_steps(int) const {
  return {3 * std::ceil((2 * rules().frame_s + rules().latency_s) / rules().step_s) - 1, 0};
}

}  // namespace aurasim::core
