#include "physics/joint_axes.h"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

class Maker {
 public:
  Maker(JointAxes& joint, double times) : joint_(joint), times_(times) {}

  void operator()(const core::BallJoint& ball) const {
    hold({0, 1, 2});
    joint_.ball_damping = ball.damping;
  }

  void operator()(const core::HingeJoint& hinge) const {
    hold({0, 1, 2, 3, 4});
    limit(5, hinge.limits);
    leave(5, hinge);
    if (!hinge.motor) return;
    joint_.has_motor = true;
    joint_.motor_rad_s = hinge.motor->speed;
    joint_.motor_impulse = times_ * hinge.motor->max_impulse;
  }

  void operator()(const core::SliderJoint& slider) const {
    hold({0, 1, 3, 4, 5});
    limit(2, slider.limits);
    leave(2, slider);
  }

  void operator()(const core::FixedJoint&) const { hold({0, 1, 2, 3, 4, 5}); }

  void operator()(const core::SpringJoint& spring) const {
    joint_.b_is_first = true;
    for (std::size_t i = 0; i < spring.axes.size(); ++i) {
      limit(i, spring.axes[i].limits);
      joint_.axes[i].stiffness = spring.axes[i].stiffness;
      joint_.axes[i].damping = spring.axes[i].damping;
      joint_.axes[i].rest = spring.axes[i].rest;
    }
  }

 private:
  void hold(std::initializer_list<std::size_t> axes) const {
    for (const std::size_t i : axes) limit(i, core::JointLimits{});
  }
  void limit(std::size_t i, const std::optional<core::JointLimits>& limits) const {
    if (!limits) return;
    joint_.axes[i].is_held = true;
    joint_.axes[i].low = limits->low, joint_.axes[i].high = limits->high;
  }
  template <class Joint>
  void leave(std::size_t i, const Joint& joint) const {
    joint_.own = i;
    joint_.resistance = joint.resistance;
    joint_.drive = joint.drive;
  }

  JointAxes& joint_;
  double times_;  ///< factor from impulses in kImpulseTime_s to those in a substep
};

}  // namespace

JointAxes axes_of(const core::JointSpec& joint, const core::JointFrame& frames, double substep_s) {
  JointAxes axes;
  const double times = substep_s / kImpulseTime_s;
  axes.frames = frames;
  axes.break_impulse = times * joint.break_impulse;
  std::visit(Maker(axes, times), joint.kind);
  return axes;
}

bool JointAxes::is_driven() const {
  return drive && !lost_its_leader && (drive->stiffness > 0 || drive->damping > 0 || drive->effort != 0);
}

bool JointAxes::counts_turns() const {
  if (own != 5u) return false;
  const Axis& turn = axes[5];
  const bool is_wide = turn.is_held && (turn.low < -std::numbers::pi || turn.high > std::numbers::pi);
  return is_wide || resistance.stiffness > 0 || (drive && drive->stiffness > 0);
}

/// Uses the leader's position at the end of each substep, as `give` does for the joint itself.
ImplicitPull drive_pull_of(const JointAxes& joint, double substep_s) {
  const core::JointDrive& drive = *joint.drive;
  const double drift = substep_s * joint.lead_speed;
  return {.position = drive.position + (joint.lead + drift),
          .drift = drift,
          .stiffness = substep_s * drive.stiffness,
          .steady = substep_s * (drive.damping * (drive.speed + joint.lead_speed) + drive.effort),
          .give = substep_s * (drive.damping + substep_s * drive.stiffness),
          .most = substep_s * drive.max_effort};
}

ImplicitPull pull_of(const core::JointResistance& resistance, double substep_s) {
  return {.position = resistance.rest,
          .stiffness = substep_s * resistance.stiffness,
          .give = substep_s * (resistance.damping + substep_s * resistance.stiffness),
          .most = std::numeric_limits<double>::infinity()};
}

core::JointMotion measure(const JointAxes& joint, const btRigidBody& a, const btRigidBody& b) {
  const btTransform X_WJ_a = a.getWorldTransform() * to_bullet(joint.frames.X_AJ);
  const btTransform X_WJ_b = b.getWorldTransform() * to_bullet(joint.frames.X_BJ);
  core::JointMotion motion;
  if (joint.own == 5u) {
    const btVector3 x_a = X_WJ_a.getBasis().getColumn(0);
    motion.position = std::atan2(static_cast<double>(x_a.dot(X_WJ_b.getBasis().getColumn(1))),
                                 static_cast<double>(x_a.dot(X_WJ_b.getBasis().getColumn(0))));
    const btVector3 w = a.getAngularVelocity() - b.getAngularVelocity();
    motion.speed = static_cast<double>(w.dot(X_WJ_a.getBasis().getColumn(2)));
  } else {
    const btVector3 along = X_WJ_b.getBasis().getColumn(2), p_J = X_WJ_a.getOrigin();
    motion.position = static_cast<double>(along.dot(p_J - X_WJ_b.getOrigin()));
    const btVector3 v_a = a.getVelocityInLocalPoint(p_J - a.getWorldTransform().getOrigin());
    const btVector3 v_b = b.getVelocityInLocalPoint(p_J - b.getWorldTransform().getOrigin());
    motion.speed = static_cast<double>(along.dot(v_a - v_b));
  }
  return motion;
}

}  // namespace aurasim::physics
