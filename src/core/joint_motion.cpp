#include "core/joint_motion.h"

#include <array>
#include <cmath>

namespace aurasim::core {
namespace {

Pose frame_in(const Pose& X_WB, const Pose& X_WJ) {
  const Quat q_BW = X_WB.q_WB.normalized().conjugate();
  return {q_BW * (X_WJ.p_WB - X_WB.p_WB), q_BW * X_WJ.q_WB.normalized()};
}

bool is_held(const SpringAxis& axis) { return axis.limits && axis.limits->low == axis.limits->high; }

}  // namespace

JointFrame frame_of(const JointSpec& joint, const Pose& X_WA, const Pose& X_WB) {
  return {frame_in(X_WA, joint.X_WJ), frame_in(X_WB, joint.X_WJ)};
}

std::optional<int> coordinate_of(const JointSpec& joint) {
  if (std::holds_alternative<HingeJoint>(joint.kind)) return 5;
  if (std::holds_alternative<SliderJoint>(joint.kind)) return 2;
  const auto* const spring = std::get_if<SpringJoint>(&joint.kind);
  if (spring == nullptr) return std::nullopt;
  std::optional<int> free;
  for (int i = 0; i < 6; ++i) {
    if (is_held(spring->axes[static_cast<std::size_t>(i)])) continue;
    if (free) return std::nullopt;
    free = i;
  }
  return free;
}

JointMotion joint_motion(const JointFrame& frame, int coordinate, const BodyState& a, const BodyState& b) {
  const Quat q_WA = a.pose.q_WB.normalized(), q_WB = b.pose.q_WB.normalized();
  const Vec3 arm_a = q_WA * frame.X_AJ.p_WB;
  const Vec3 p_WJa = a.pose.p_WB + arm_a;
  const Mat3 R_WJb = (q_WB * frame.X_BJ.q_WB).toRotationMatrix();
  const auto axis = static_cast<Eigen::Index>(coordinate % 3);
  if (coordinate < 3) {
    const Vec3 p_WJb = b.pose.p_WB + q_WB * frame.X_BJ.p_WB;
    const Vec3 apart = p_WJa - p_WJb;
    // Relative to b, which turns.
    const Vec3 v_of_b = b.v_WB + b.w_WB.cross(Vec3(p_WJa - b.pose.p_WB));
    const Vec3 v_of_a = a.v_WB + a.w_WB.cross(arm_a);
    return {R_WJb.col(axis).dot(apart), R_WJb.col(axis).dot(Vec3(v_of_a - v_of_b))};
  }
  const Mat3 R_BA = R_WJb.transpose() * (q_WA * frame.X_AJ.q_WB).toRotationMatrix();
  const Eigen::Index next = (axis + 1) % 3, last = (axis + 2) % 3;
  // For the angle about x, the column of y holds the sine in row z and the cosine in row y. The other axes follow
  // cyclically.
  const double angle = std::atan2(R_BA(last, next), R_BA(next, next));
  return {angle, R_WJb.col(axis).dot(Vec3(a.w_WB - b.w_WB))};
}

}  // namespace aurasim::core
