#include "core/aura.h"

#include <algorithm>

#include "core/horizon.h"

namespace aurasim::core {

Path path_of(const BodyState& body, Step now, const ClearanceQuery& clearance) {
  return path_from(body, body.awake, now, clearance);
}

/// The reach from which all distances follow: the largest distance from which two bodies can come together. The range
/// is evaluated at the drift of the own body.
Range Aura::reach(const Steps& steps, double other_drift_m_s) const {
  const Range own = span(steps.own);
  const Range other = span(steps.other);
  const double margin = unfallen_m(std::max(steps.own, steps.other)) + rules_.contact_margin_m;
  return {own.fixed_m + other.at(other_drift_m_s) + margin, own.per_speed_s};
}

double Aura::zone(double speed_m_s, int hops, double other_speed_m_s, double other_radius_m) const {
  const Range range = reach(steps(Question::kZone, hops), most_drift(other_speed_m_s));
  return range.at(most_drift(speed_m_s)) + other_radius_m;
}

Range Aura::notice(double foreign_speed_m_s, double foreign_age_steps, int hops) const {
  Steps on_the_way = steps(Question::kNotice, hops);
  if (predicts()) on_the_way.other += foreign_age_steps;
  return by_speed(reach(on_the_way, most_drift(foreign_speed_m_s)));
}

Range Aura::meet_range(const Path& foreign, int hops) const {
  Steps on_the_way = steps(Question::kMeeting, hops);
  if (predicts()) on_the_way.other += foreign.age_steps;
  Range range = reach(on_the_way, drift_m_s(foreign));
  range.fixed_m += foreign.blur_m;
  return range;
}

Range Aura::link_range(int hops) const { return by_speed(reach(steps(Question::kLink, hops), 0)); }

double Aura::listening_distance_m(double largest_radius_m) const {
  return zone(rules_.top_speed_m_s, 1 + rules_.homeward_hops(), rules_.top_speed_m_s, largest_radius_m) +
         largest_radius_m;
}

/// For how long the body of `path` will have moved `steps` from now, in seconds. 0 or less: it has not moved yet.
double Aura::time_ahead(const Path& path, double steps) const {
  if (!path.moves) return 0;
  const double k = path.age_steps + steps - (path.unborn_steps > 0 ? path.age_steps + path.unborn_steps : 0);
  return k * rules_.step_s;
}

Vec3 Aura::place_ahead(const Path& path, double steps) const {
  const double t = time_ahead(path, steps);
  if (t <= 0) return path.pose.p_WB;
  const double h = rules_.looks_once ? 0 : rules_.step_s / rules_.substeps;
  // Bullet integrates velocity before position: in t, m substeps of length h fall g h^2 m (m+1) / 2 = g t (t + h) / 2.
  return path.pose.p_WB + path.v_WB * t + rules_.gravity * (0.5 * t * (t + h));
}

Pose Aura::ahead(const Path& path, double steps) const {
  const double t = time_ahead(path, steps);
  Pose pose{place_ahead(path, steps), path.pose.q_WB};
  if (t <= 0) return pose;
  const double spin = path.w_WB.norm();
  if (spin > 1e-6) pose.q_WB = Quat(Eigen::AngleAxisd(spin * t, path.w_WB / spin)) * path.pose.q_WB;
  return pose;
}

}  // namespace aurasim::core
