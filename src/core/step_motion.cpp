#include "core/step_motion.h"

#include <algorithm>
#include <cmath>

namespace aurasim::core {

double bulge(double longest, double apart) {
  return longest > apart ? 0.5 * std::sqrt(longest * longest - apart * apart) : 0;
}

StepMotion StepMotions::of(const Path& now, const Path* before) const {
  const double step_s = aura_.rules().step_s;
  StepMotion motion{now, now, 0};
  const double fall_m_s = aura_.rules().gravity.norm() * step_s;
  if (before) {
    motion.at_start = *before;
  } else if (now.moves) {
    motion.at_start.pose.p_WB -= step_s * now.v_WB;
    motion.stray_m = step_s * (now.v_WB.norm() + fall_m_s);
  }
  const Path& start = motion.at_start;
  if (!start.moves && !now.moves) return motion;
  const double fastest = std::max(start.v_WB.norm(), now.v_WB.norm()) + fall_m_s;
  motion.stray_m += bulge(step_s * fastest, (now.pose.p_WB - start.pose.p_WB).norm());
  const Quat turned = pose(motion, 1).q_WB;
  const double off = std::max(turned.angularDistance(now.pose.q_WB), step_s * (now.w_WB - start.w_WB).norm());
  motion.stray_m += std::min(2.0, off) * now.radius_m;
  return motion;
}

/// Pose after a `share`, 0 to 1, of the step: on the straight way, with the spin of the start.
Pose StepMotions::pose(const StepMotion& motion, double share) const {
  const Pose& from = motion.at_start.pose;
  Pose pose{from.p_WB + share * (motion.at_end.pose.p_WB - from.p_WB), from.q_WB};
  const double spin = motion.at_start.w_WB.norm();
  if (motion.at_start.moves && spin > 1e-6) {
    const double angle = spin * share * aura_.rules().step_s;
    pose.q_WB = Quat(Eigen::AngleAxisd(angle, motion.at_start.w_WB / spin)) * from.q_WB;
  }
  return pose;
}

/// Could continuous collision detection stop `moving` at `other`? Physics moves a body ahead by a substep and tests
/// what is in its way, at that one's pose before or after the substep.
bool StepMotions::sweeps_into(const StepMotion& moving, const StepMotion& other, double share, double allowed_m) const {
  if (!moving.at_end.moves && !moving.at_start.moves) return false;
  const double half = 0.5 / aura_.rules().looks();
  const double way = (moving.at_end.pose.p_WB - moving.at_start.pose.p_WB).norm() * half +
                     (other.at_end.pose.p_WB - other.at_start.pose.p_WB).norm() * 2 * half;
  const Pose middle = pose(moving, share + half);
  const Pose at = pose(other, share);
  const double allowed = allowed_m + way + moving.stray_m + other.stray_m;
  if ((middle.p_WB - at.p_WB).norm() - moving.at_end.radius_m - other.at_end.radius_m > allowed) return false;
  return aura_.clearance().clearance(moving.at_end.prototype, middle, other.at_end.prototype, at, allowed) <= allowed;
}

/// Do two bodies touch within `allowed_m` while the first comes by `way`? By conservative advancement (Mirtich 1996).
bool StepMotions::meet_on(const Pose& a, const Pose& b, const StepMotion& of_a, const StepMotion& of_b, const Vec3& way,
                          double allowed_m) const {
  constexpr double kShortest_m = 0.001;
  const double length = way.norm();
  for (double gone = 0;;) {
    const Pose at{a.p_WB + (length > 0 ? gone / length : 0) * way, a.q_WB};
    const double limit = allowed_m + length - gone;
    double gap = (at.p_WB - b.p_WB).norm() - of_a.at_end.radius_m - of_b.at_end.radius_m;
    if (gap > limit) return false;
    gap = aura_.clearance().clearance(of_a.at_end.prototype, at, of_b.at_end.prototype, b, limit);
    if (gap > limit) return false;
    if (gap <= allowed_m + kShortest_m) return true;
    gone += gap - allowed_m;
  }
}

/// Could a contact ahead of time (physics/soft/ahead.h) begin? Physics extrapolates two bodies from the start of the
/// step, straight and without turning, with their velocities there; if they were kicked, with those at the end.
bool StepMotions::meet_ahead(const StepMotion& a, const StepMotion& b, double allowed_m) const {
  const double step_s = aura_.rules().step_s;
  const Vec3 fall = 0.5 * step_s * step_s * aura_.rules().gravity;
  const auto from_start = [&](const StepMotion& m) -> Vec3 {
    return m.at_start.moves ? Vec3(step_s * m.at_start.v_WB + fall) : Vec3(Vec3::Zero());
  };
  const auto as_at_end = [&](const StepMotion& m) -> Vec3 {
    return m.at_end.moves ? Vec3(step_s * m.at_end.v_WB - fall) : Vec3(Vec3::Zero());
  };
  const Pose &at = a.at_start.pose, &bt = b.at_start.pose;
  const Vec3 way = from_start(a) - from_start(b), way_at_end = as_at_end(a) - as_at_end(b);
  if (meet_on(at, bt, a, b, way, allowed_m)) return true;
  return (way - way_at_end).norm() > allowed_m && meet_on(at, bt, a, b, way_at_end, allowed_m);
}

bool StepMotions::touch(const StepMotion& a, const StepMotion& b) const {
  const int substeps = aura_.rules().looks();
  const double margin = aura_.rules().contact_margin_m * aura_.rules().check_scale;
  if (aura_.rules().looks_ahead()) return meet_ahead(a, b, margin + a.at_end.blur_m + b.at_end.blur_m);
  for (int i = 0; i < substeps; ++i) {
    const double share = static_cast<double>(i) / substeps;
    const double allowed = margin + a.at_end.blur_m + b.at_end.blur_m + (i > 0 ? a.stray_m + b.stray_m : 0);
    if (aura_.rules().sweeps && (sweeps_into(a, b, share, allowed) || sweeps_into(b, a, share, allowed))) return true;
    const Pose at = pose(a, share);
    const Pose bt = pose(b, share);
    const double gap = (at.p_WB - bt.p_WB).norm() - a.at_end.radius_m - b.at_end.radius_m;
    if (gap > allowed) continue;
    if (aura_.clearance().clearance(a.at_end.prototype, at, b.at_end.prototype, bt, allowed) <= allowed) return true;
  }
  return false;
}

}  // namespace aurasim::core
