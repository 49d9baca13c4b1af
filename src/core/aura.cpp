#include "core/aura.h"

#include <algorithm>
#include <cmath>

namespace aurasim::core {
namespace {

/// Contacts are sought at every substep, so the last (S-1)/S of a step counts, for both bodies.
double substep_share(const AuraRules& r) { return 2.0 * (r.substeps - 1) / r.substeps; }

/// Steps that the two bodies travel more when a pull can chain through `hops` regions.
double chain_steps(const AuraRules& r, int hops) { return 2.0 * (hops - 1) * r.lookahead; }

double thesis_reach(const AuraRules& r) {
  const double delay_steps = std::ceil((2 * r.frame_s + r.latency_s) / r.step_s);
  return (3 * delay_steps - 1) * r.step_s * r.top_speed_m_s;
}

constexpr double kRestSpeed = 0.05;  // m/s: a sleeping body may creep
constexpr double kSpeedFloor = 0.1;  // m/s: contacts of slow bodies

}  // namespace

Path path_of(const BodyState& body, Step now, const ClearanceQuery& clearance) {
  Path path;
  path.prototype = body.prototype;
  path.radius_m = clearance.bounding_radius(body.prototype);
  path.pose = body.pose;
  path.v_WB = body.v_WB;
  path.w_WB = body.w_WB;
  path.moves = body.awake;
  path.unborn_steps = static_cast<double>(std::max<Step>(0, body.birth - now));
  return path;
}

double Aura::reach(int hops) const {
  if (rules_.kind == AuraKind::kThesis) return rules_.reach_scale * thesis_reach(rules_);
  const double steps = 3.0 * rules_.lookahead - 2 + substep_share(rules_) + chain_steps(rules_, hops);
  return rules_.reach_scale * steps * rules_.step_s * rules_.top_speed_m_s;
}

double Aura::foreign_reach(int hops) const {
  if (rules_.kind == AuraKind::kThesis) return rules_.reach_scale * thesis_reach(rules_);
  const double steps = 5.0 * rules_.lookahead - 2 + substep_share(rules_) + chain_steps(rules_, hops);
  return rules_.reach_scale * steps * rules_.step_s * rules_.top_speed_m_s;
}

double Aura::cluster_reach(int hops) const {
  if (rules_.kind == AuraKind::kThesis) return rules_.reach_scale * thesis_reach(rules_);
  const double steps = 4.0 * rules_.lookahead - 3 + substep_share(rules_) + chain_steps(rules_, hops);
  return rules_.reach_scale * steps * rules_.step_s * rules_.top_speed_m_s;
}

double Aura::calm_speed(bool awake) const {
  if (rules_.kind != AuraKind::kSwept) return rules_.top_speed_m_s;
  return awake ? kSpeedFloor : kRestSpeed;
}

double Aura::own_speed_of(const BodyState& body) const {
  if (rules_.kind != AuraKind::kSwept || !body.awake) return 0;
  // A kick that nobody else can foresee takes the body off its path by the kick's speed, of which U covers a share.
  const double share = std::clamp(rules_.uncertainty, 0.1, 1.0);
  return body.v_WB.norm() + body.coming_kick_m_s / share;
}

double Aura::drop_m(double steps) const {
  const double t = steps * rules_.step_s;
  return 0.5 * gravity_m_s2_ * t * (t + rules_.step_s);
}

double Aura::last_instant(int horizon_steps) const { return std::max(0.0, horizon_steps - 1.0 / rules_.substeps); }

Pose Aura::ahead(const Path& path, double steps) const {
  const double k = path.age_steps + steps - (path.unborn_steps > 0 ? path.age_steps + path.unborn_steps : 0);
  if (!path.moves || k <= 0) return path.pose;
  const double t = k * rules_.step_s;
  const double h = rules_.step_s / rules_.substeps;
  // Bullet integrates speed before place: m substeps of length h fall g h^2 m (m+1) / 2 = g t (t + h) / 2.
  Pose pose{path.pose.p_WB + path.v_WB * t + rules_.gravity * (0.5 * t * (t + h)), path.pose.q_WB};
  const double spin = path.w_WB.norm();
  if (spin > 1e-6) pose.q_WB = Quat(Eigen::AngleAxisd(spin * t, path.w_WB / spin)) * path.pose.q_WB;
  return pose;
}

bool Aura::spheres_within(const Path& a, const Path& b, double distance_m) const {
  const double d = a.radius_m + b.radius_m + rules_.contact_margin_m + a.blur_m + b.blur_m + distance_m;
  return (a.pose.p_WB - b.pose.p_WB).squaredNorm() <= d * d;
}

bool Aura::meets(const Path& foreign, const Path& own, int hops, int fewer_steps) const {
  switch (rules_.kind) {
    case AuraKind::kNone:
      return false;
    case AuraKind::kThesis:
    case AuraKind::kTight:
      return spheres_within(foreign, own, reach(hops));
    case AuraKind::kSwept:
      break;
  }
  return first_meeting(foreign, own, hops, fewer_steps).has_value();
}

bool Aura::linked(const Path& a, const Path& b, int hops) const {
  switch (rules_.kind) {
    case AuraKind::kNone:
      return false;
    case AuraKind::kThesis:
    case AuraKind::kTight:
      return spheres_within(a, b, cluster_reach(hops));
    case AuraKind::kSwept:
      break;
  }
  return paths_meet(a, b, (hops + 1) * rules_.lookahead - 1).has_value();
}

bool Aura::meets_ghost(const Path& ghost, const Path& own, int hops, int fewer_steps) const {
  return rules_.kind == AuraKind::kSwept ? meets(ghost, own, hops, fewer_steps) : linked(ghost, own, hops);
}

double Aura::zone(double speed_m_s, int hops, double other_speed_m_s, double other_radius_m) const {
  if (rules_.kind != AuraKind::kSwept) return reach(hops) + other_radius_m + rules_.contact_margin_m;
  const double own_steps = (1 + hops) * rules_.lookahead;
  const double other_steps = hops * rules_.lookahead;
  const double way = (1 + rules_.uncertainty) * rules_.step_s * (speed_m_s * own_steps + other_speed_m_s * other_steps);
  return way + 2 * drop_m(own_steps) + drop_m(other_steps) + other_radius_m + rules_.contact_margin_m;
}

Aura::Range Aura::notice(double foreign_speed_m_s, double foreign_age_steps, int hops) const {
  if (rules_.kind != AuraKind::kSwept) return {foreign_reach(hops) + rules_.contact_margin_m, 0};
  const double own_steps = (1 + hops) * rules_.lookahead;
  const double foreign_steps = foreign_age_steps + own_steps;
  const double way_per_speed = (1 + rules_.uncertainty) * rules_.step_s;
  const double drop = 2 * drop_m(foreign_steps) + drop_m(own_steps);
  return {way_per_speed * foreign_speed_m_s * foreign_steps + drop + rules_.contact_margin_m,
          way_per_speed * own_steps};
}

double Aura::drift_m_s(const Path& path) const { return path.v_WB.norm() + rules_.uncertainty * path.speed_m_s; }

Aura::Range Aura::meet_range(const Path& foreign, int hops) const {
  const double margin = rules_.contact_margin_m + foreign.blur_m;
  if (rules_.kind != AuraKind::kSwept) return {std::max(reach(hops), cluster_reach(hops)) + margin, 0};
  const double own_steps = last_instant(hops * rules_.lookahead);
  const double foreign_steps = foreign.age_steps + own_steps;
  const double way = rules_.step_s * foreign_steps * drift_m_s(foreign) + 2 * drop_m(foreign_steps) + drop_m(own_steps);
  return {std::max(1.0, rules_.reach_scale) * (margin + way),
          std::max(1.0, rules_.reach_scale) * rules_.step_s * own_steps};
}

Aura::Range Aura::link_range(int hops) const {
  if (rules_.kind != AuraKind::kSwept) return {cluster_reach(hops) + rules_.contact_margin_m, 0};
  const double steps = last_instant((hops + 1) * rules_.lookahead - 1);
  return {3 * drop_m(steps) + rules_.contact_margin_m, (1 + rules_.uncertainty) * rules_.step_s * steps};
}

std::optional<double> Aura::first_meeting(const Path& a, const Path& b, int hops, int fewer_steps) const {
  return paths_meet(a, b, hops * rules_.lookahead - fewer_steps);
}

std::optional<double> Aura::paths_meet(const Path& a, const Path& b, int horizon_steps) const {
  const int substeps = rules_.substeps;
  const double spread = rules_.uncertainty * rules_.step_s;
  const double last = horizon_steps;
  // The clearance shrinks at most this fast, in metres per step.
  const double oldest = std::max(a.age_steps, b.age_steps);
  const double fall = gravity_m_s2_ * (a.age_steps + b.age_steps + oldest + 3 * last) * rules_.step_s;
  const double closing =
      rules_.step_s * ((a.v_WB - b.v_WB).norm() + fall + a.w_WB.norm() * a.radius_m + b.w_WB.norm() * b.radius_m +
                       rules_.uncertainty * (a.speed_m_s + b.speed_m_s));
  for (int i = 0; i < horizon_steps * substeps;) {
    const double k = static_cast<double>(i) / substeps;
    if (k + 1e-9 < std::max(a.unborn_steps, b.unborn_steps)) {
      ++i;
      continue;
    }
    const Pose at = ahead(a, k);
    const Pose bt = ahead(b, k);
    // One of them may stand on something and not fall as its path says. If both do, that makes no difference.
    const double unfallen = drop_m(std::max(a.moves ? a.age_steps + k : 0, b.moves ? b.age_steps + k : 0));
    const double allowed =
        rules_.reach_scale * (rules_.contact_margin_m + a.blur_m + b.blur_m + unfallen +
                              spread * (a.speed_m_s * (a.age_steps + k) + b.speed_m_s * (b.age_steps + k)));
    double clearance = (at.p_WB - bt.p_WB).norm() - a.radius_m - b.radius_m;
    if (clearance <= allowed) {
      const double limit = allowed + closing * (last - k);
      clearance = clearance_.clearance(a.prototype, at, b.prototype, bt, limit);
      if (clearance <= allowed) return k;
    }
    const double free_steps = closing > 0 ? (clearance - allowed) / closing : last;
    i += std::max(1, static_cast<int>(std::min(free_steps, last) * substeps));
  }
  return std::nullopt;
}

}  // namespace aurasim::core
