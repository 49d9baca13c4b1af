#include "core/static_path.h"

#include <algorithm>
#include <cmath>

namespace aurasim::core {
namespace {

/// Rotation at `share` of the angle between two rotations, on the shorter way. Halves the angle kHalves times and
/// interpolates on the rest's chord, which hardly differs from its arc.
Quat turned(Quat from, Quat to, double share) {
  constexpr int kHalves = 10;
  if (from.dot(to) < 0) to.coeffs() = -to.coeffs();
  for (int i = 0; i < kHalves; ++i) {
    const Quat middle(Eigen::Vector4d(from.coeffs() + to.coeffs()).normalized());
    (share < 0.5 ? to : from) = middle;
    share = share < 0.5 ? 2 * share : 2 * share - 1;
  }
  return Quat(Eigen::Vector4d((1 - share) * from.coeffs() + share * to.coeffs()).normalized());
}

/// Pose on the path at time t_s, in the frame S of the static at the start.
Pose along(const StaticPath& path, double t_s) {
  const double ends_s = path.stops.back().at_s;
  if (path.repeats) t_s -= std::floor(t_s / ends_s) * ends_s;
  const auto next = std::ranges::upper_bound(path.stops, t_s, {}, &PathStop::at_s);
  if (next == path.stops.end()) return path.stops.back().X_SP;
  const PathStop before = next == path.stops.begin() ? PathStop{} : *(next - 1);
  const double share = (t_s - before.at_s) / (next->at_s - before.at_s);
  return pose_between(before.X_SP, next->X_SP, path.smooth ? share * share * (3 - 2 * share) : share);
}

}  // namespace

Pose pose_between(const Pose& from, const Pose& to, double share) {
  return {from.p_WB + share * (to.p_WB - from.p_WB), turned(from.q_WB.normalized(), to.q_WB.normalized(), share)};
}

Pose pose_at(const StaticBody& body, double t_s) {
  if (!body.path) return body.pose;
  return Pose{body.pose.p_WB, body.pose.q_WB.normalized()} * along(*body.path, t_s);
}

Twist twist_between(const Pose& before, const Pose& after, double duration_s) {
  const Quat turn = after.q_WB * before.q_WB.conjugate();
  const Vec3 sine = (turn.w() < 0 ? -1 : 1) * turn.vec();  // sine of half the angle, times the axis
  const double square = sine.squaredNorm();
  const double arc = 1 + square / 6 * (1 + square * 9 / 20 * (1 + square * 25 / 42 * (1 + square * 49 / 72)));
  return {(after.p_WB - before.p_WB) / duration_s, 2 * arc / duration_s * sine};
}

}  // namespace aurasim::core
