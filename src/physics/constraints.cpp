#include "physics/constraints.h"

#include <algorithm>
#include <numbers>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/driven_constraint.h"

namespace aurasim::physics {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

/// Turns J so that its x axis is the joint's z axis, because Bullet's sliders slide along x.
btTransform with_x_along_z(const Pose& X_BJ) {
  const Quat z_to_x(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitY()));
  return to_bullet(Pose{X_BJ.p_WB, X_BJ.q_WB * z_to_x});
}

class Maker {
 public:
  Maker(const core::JointFrame& frames, btRigidBody& a, btRigidBody& b, double substep_s)
      : frames_(frames), a_(a), b_(b), substep_s_(substep_s), times_(substep_s / kImpulseTime_s) {}

  std::unique_ptr<btTypedConstraint> operator()(const core::BallJoint&) const {
    return std::make_unique<Driven<btPoint2PointConstraint>>(substep_s_, a_, b_, to_bullet(frames_.X_AJ.p_WB),
                                                             to_bullet(frames_.X_BJ.p_WB));
  }

  std::unique_ptr<btTypedConstraint> operator()(const core::HingeJoint& joint) const {
    auto hinge = std::make_unique<Driven<btHingeConstraint>>(substep_s_, a_, b_, to_bullet(frames_.X_AJ),
                                                             to_bullet(frames_.X_BJ));
    constexpr btScalar kSoftness = btScalar(0.9);
    constexpr btScalar kBias = btScalar(0.3);
    constexpr btScalar kBounce = 0;  // with Bullet's default, 1, every joint rattles at its limits
    if (joint.limits && is_within_half_a_turn(*joint.limits)) {
      hinge->setLimit(scalar(joint.limits->low), scalar(joint.limits->high), kSoftness, kBias, kBounce);
    }
    if (joint.motor)
      hinge->enableAngularMotor(true, scalar(joint.motor->speed), scalar(times_ * joint.motor->max_impulse));
    return hinge;
  }

  std::unique_ptr<btTypedConstraint> operator()(const core::SliderJoint& joint) const {
    constexpr bool kAsSeenFromA = false;
    auto slider = std::make_unique<Driven<btSliderConstraint>>(substep_s_, a_, b_, with_x_along_z(frames_.X_AJ),
                                                               with_x_along_z(frames_.X_BJ), kAsSeenFromA);
    slider->setLowerLinLimit(scalar(joint.limits ? joint.limits->low : 1));  // low > high: free
    slider->setUpperLinLimit(scalar(joint.limits ? joint.limits->high : -1));
    slider->setLowerAngLimit(0);
    slider->setUpperAngLimit(0);
    return slider;
  }

  std::unique_ptr<btTypedConstraint> operator()(const core::FixedJoint&) const {
    return std::make_unique<btFixedConstraint>(a_, b_, to_bullet(frames_.X_AJ), to_bullet(frames_.X_BJ));
  }

  /// Bullet measures the position of its second body relative to its first, but the rotation of its first relative to
  /// its second.
  std::unique_ptr<btTypedConstraint> operator()(const core::SpringJoint& joint) const {
    auto spring = std::make_unique<btGeneric6DofSpring2Constraint>(b_, a_, to_bullet(frames_.X_BJ),
                                                                   to_bullet(frames_.X_AJ), RO_ZYX);
    for (int i = 0; i < 6; ++i) {
      const core::SpringAxis& axis = joint.axes[static_cast<std::size_t>(i)];
      const core::JointLimits of_a = axis.limits.value_or(core::JointLimits{1, -1});  // low > high: free
      const core::JointLimits limits = i >= 3 && axis.limits ? core::JointLimits{-of_a.high, -of_a.low} : of_a;
      constexpr double kFarthest = 1e9;  // limits are kept finite, because Bullet multiplies by them
      spring->setLimit(i, scalar(std::max(limits.low, -kFarthest)), scalar(std::min(limits.high, kFarthest)));
      if (axis.stiffness == 0 && axis.damping == 0) continue;
      spring->enableSpring(i, true);
      spring->setStiffness(i, scalar(axis.stiffness));
      spring->setDamping(i, scalar(axis.damping));
      spring->setEquilibriumPoint(i, scalar(i >= 3 ? 0 - axis.rest : axis.rest));
    }
    return spring;
  }

 private:
  const core::JointFrame& frames_;
  btRigidBody& a_;
  btRigidBody& b_;
  double substep_s_;
  double times_;  ///< factor from impulses in kImpulseTime_s to those in a substep
};

}  // namespace

std::unique_ptr<btTypedConstraint> make_constraint(const core::JointSpec& joint, const core::JointFrame& frames,
                                                   btRigidBody& a, btRigidBody& b, double substep_s) {
  const double times = substep_s / kImpulseTime_s;
  auto constraint = std::visit(Maker(frames, a, b, substep_s), joint.kind);
  if (joint.break_impulse < static_cast<double>(SIMD_INFINITY)) {
    constraint->setBreakingImpulseThreshold(scalar(times * joint.break_impulse));
  }
  return constraint;
}

}  // namespace aurasim::physics
