#include "core/swept_aura.h"

#include <algorithm>
#include <cmath>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

constexpr double kRestSpeed = 0.05;  // m/s: a sleeping body may creep
constexpr double kSpeedFloor = 0.1;  // m/s: contacts of slow bodies

}  // namespace

double SweptAura::speed_of(const BodyState& body) const {
  if (!body.awake) return kRestSpeed;
  // Other nodes cannot foresee a kick. It takes the body off its path at the kick's speed, and an aura allows only for
  // U times its stated speed. So the kick counts as much larger.
  const double share = std::clamp(rules().uncertainty, 0.1, 1.0);
  return kSpeedFloor + body.v_WB.norm() + body.coming_kick_m_s / share;
}

bool SweptAura::meets(const Path& foreign, const Path& own, int hops) const {
  return paths_meet(foreign, own, horizon::meeting(rules().lookahead, hops));
}

bool SweptAura::may_approach(const Path& foreign, const Path& own, int hops) const {
  return !rules().redo || !stay_apart(foreign, own, horizon::announcing(rules().lookahead, hops));
}

bool SweptAura::linked(const Path& a, const Path& b, int hops) const {
  return paths_meet(a, b, horizon::linking(rules().lookahead, hops));
}

bool SweptAura::meets_ghost(const Path& ghost, const Path& own, int hops) const { return meets(ghost, own, hops); }

Aura::Steps SweptAura::steps(Question question, int hops) const {
  const int k = rules().lookahead;
  switch (question) {
    case Question::kZone:
      return {1.0 * horizon::announcing(k, hops), 1.0 * horizon::meeting(k, hops)};
    case Question::kNotice:
      return {1.0 * horizon::announcing(k, hops), 1.0 * horizon::announcing(k, hops)};
    case Question::kMeeting: {
      const double last = last_instant(horizon::meeting(k, hops));
      return {last, last};
    }
    case Question::kLink:
      break;
  }
  const double last = last_instant(horizon::linking(k, hops));
  return {last, last};
}

Range SweptAura::span(double steps) const { return {drop_m(steps), rules().step_s * steps}; }

double SweptAura::drop_m(double steps) const {
  const double t = steps * rules().step_s;
  return 0.5 * gravity_m_s2() * t * (t + rules().step_s);
}

double SweptAura::last_instant(int horizon_steps) const {
  return std::max(0.0, horizon_steps - 1.0 / rules().instants());
}

/// Two bodies meet if they are this near to each other `steps` from now.
double SweptAura::allowed_m(const Path& a, const Path& b, double steps) const {
  // Where physics looks ahead, half of the relative way between two instants is added.
  const double half_way =
      rules().looks_ahead() ? 0.5 * rules().step_s * (a.v_WB - b.v_WB).norm() / rules().instants() : 0;
  // One of the two may stand on something and not fall as its path assumes. If both stand, their distance is the same.
  const double unfallen = drop_m(std::max(a.moves ? a.age_steps + steps : 0, b.moves ? b.age_steps + steps : 0));
  const double off_path = rules().uncertainty * rules().step_s *
                          (a.speed_m_s * (a.age_steps + steps) + b.speed_m_s * (b.age_steps + steps));
  return rules().reach_scale * (rules().contact_margin_m + half_way + a.blur_m + b.blur_m + unfallen + off_path);
}

/// True if the bounding spheres of two bodies come at no time within `last` steps as near to each other as they may be
/// at the end. Cheap, and right for most pairs. Of two bodies that fall, each sees the other on a straight way; the way
/// of a falling body past a sleeping one bulges.
bool SweptAura::stay_apart(const Path& a, const Path& b, double last) const {
  if (a.unborn_steps > 0 || b.unborn_steps > 0) return false;
  const Vec3 from = place_ahead(a, 0) - place_ahead(b, 0);
  const Vec3 way = place_ahead(a, last) - place_ahead(b, last) - from;
  const double length_squared = way.squaredNorm();
  const double share = length_squared > 0 ? std::clamp(-from.dot(way) / length_squared, 0.0, 1.0) : 0;
  const double t = last * rules().step_s;
  const double bulge = a.moves != b.moves ? gravity_m_s2() * t * t / 8 : 0;
  return (from + share * way).norm() - a.radius_m - b.radius_m > allowed_m(a, b, last) + bulge;
}

bool SweptAura::paths_meet(const Path& a, const Path& b, int horizon_steps) const {
  const int instants = rules().instants();
  const double last = horizon_steps;
  if (stay_apart(a, b, last)) return false;
  // Upper bound of how fast the clearance shrinks, in metres per step.
  const double oldest = std::max(a.age_steps, b.age_steps);
  const double fall = gravity_m_s2() * (a.age_steps + b.age_steps + oldest + 3 * last) * rules().step_s;
  const double closing =
      rules().step_s * ((a.v_WB - b.v_WB).norm() + fall + a.w_WB.norm() * a.radius_m + b.w_WB.norm() * b.radius_m +
                        rules().uncertainty * (a.speed_m_s + b.speed_m_s));
  for (int i = 0; i < horizon_steps * instants;) {
    const double k = static_cast<double>(i) / instants;
    if (k + 1e-9 < std::max(a.unborn_steps, b.unborn_steps)) {
      ++i;
      continue;
    }
    const double allowed = allowed_m(a, b, k);
    double gap = (place_ahead(a, k) - place_ahead(b, k)).norm() - a.radius_m - b.radius_m;
    if (gap <= allowed) {
      const double limit = allowed + closing * (last - k);
      gap = clearance().clearance(a.prototype, ahead(a, k), b.prototype, ahead(b, k), limit);
      if (gap <= allowed) return true;
    }
    const double free_steps = closing > 0 ? (gap - allowed) / closing : last;
    i += std::max(1, static_cast<int>(std::min(free_steps, last) * instants));
  }
  return false;
}

}  // namespace aurasim::core
