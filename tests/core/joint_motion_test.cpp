// Where joints stand, from the states of their bodies.
#include "core/joint_motion.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr double kNear = 1e-12;

class AJoint : public ::testing::Test {
 protected:
  AJoint() {
    X_WA_.p_WB = {1, 2, 3};
    X_WB_.p_WB = {-1, 0, 2};
    X_WB_.q_WB = Quat(Eigen::AngleAxisd(0.4, Vec3(1, 1, 0).normalized()));
    joint_.a = BodyId{1};
    joint_.b = BodyId{2};
    joint_.X_WJ = {{0, 1, 2.5}, Quat(Eigen::AngleAxisd(-0.9, Vec3(0, 1, 2).normalized()))};
  }

  /// `a` moved by this in J as it was in state 0; then everything is turned and moved, which changes nothing.
  JointMotion after(const Pose& X_JJ, const Vec3& v_J = Vec3::Zero(), const Vec3& w_J = Vec3::Zero()) const {
    const JointFrame frame = frame_of(joint_, X_WA_, X_WB_);
    const Quat q_WJ = joint_.X_WJ.q_WB;
    BodyState a, b;
    b.pose = X_WB_;
    const Pose X_WJa{joint_.X_WJ.p_WB + q_WJ * X_JJ.p_WB, q_WJ * X_JJ.q_WB};
    const Quat q_JA = frame.X_AJ.q_WB.conjugate();
    a.pose.q_WB = X_WJa.q_WB * q_JA;
    a.pose.p_WB = X_WJa.p_WB - a.pose.q_WB * frame.X_AJ.p_WB;
    a.w_WB = q_WJ * w_J;
    a.v_WB = q_WJ * v_J - a.w_WB.cross(Vec3(X_WJa.p_WB - a.pose.p_WB));
    const Quat turn(Eigen::AngleAxisd(1.1, Vec3(3, -1, 0.5).normalized()));
    const Vec3 spin(0.3, -0.7, 1.9), drift(5, 4, 3);
    for (BodyState* body : {&a, &b}) {
      body->v_WB = turn * body->v_WB + spin.cross(Vec3(turn * body->pose.p_WB)) + drift;
      body->w_WB = turn * body->w_WB + spin;
      body->pose = {turn * body->pose.p_WB, turn * body->pose.q_WB};
    }
    return joint_motion(frame, *coordinate_of(joint_), a, b);
  }

  JointSpec joint_;
  Pose X_WA_, X_WB_;
};

TEST_F(AJoint, StandsAtNothingInTheStateThatItIsMadeIn) {
  for (const JointKind& kind : {JointKind(HingeJoint{}), JointKind(SliderJoint{})}) {
    joint_.kind = kind;
    EXPECT_NEAR(after({}).position, 0, kNear);
    EXPECT_NEAR(after({}).speed, 0, kNear);
  }
}

TEST_F(AJoint, OfAHingeIsTheTurnOfAAboutZ) {
  joint_.kind = HingeJoint{};
  for (const double angle : {0.3, -1.2, 3.0, -3.1}) {
    const JointMotion motion =
        after({Vec3::Zero(), Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))}, Vec3::Zero(), Vec3(0, 0, 2.5));
    EXPECT_NEAR(motion.position, angle, kNear);
    EXPECT_NEAR(motion.speed, 2.5, kNear);
  }
}

TEST_F(AJoint, OfASliderIsTheWayOfAAlongZ) {
  joint_.kind = SliderJoint{};
  const JointMotion motion = after({Vec3(0, 0, -0.75), Quat::Identity()}, Vec3(0, 0, 3));
  EXPECT_NEAR(motion.position, -0.75, kNear);
  EXPECT_NEAR(motion.speed, 3, kNear);
}

TEST_F(AJoint, OfASpringIsItsOnlyFreeAxis) {
  for (int axis = 0; axis < 6; ++axis) {
    SpringJoint spring;
    for (SpringAxis& held : spring.axes) held.limits = JointLimits{};
    spring.axes[static_cast<std::size_t>(axis)].limits = JointLimits{-1, 1};
    joint_.kind = spring;
    ASSERT_EQ(coordinate_of(joint_), axis);
    const Vec3 along = Vec3::Unit(axis % 3);
    const Pose moved =
        axis < 3 ? Pose{0.4 * along, Quat::Identity()} : Pose{Vec3::Zero(), Quat(Eigen::AngleAxisd(0.4, along))};
    const JointMotion motion = axis < 3 ? after(moved, 1.5 * along) : after(moved, Vec3::Zero(), 1.5 * along);
    EXPECT_NEAR(motion.position, 0.4, kNear) << axis;
    EXPECT_NEAR(motion.speed, 1.5, kNear) << axis;
  }
}

TEST_F(AJoint, WithNoneOrSeveralHasNoCoordinate) {
  joint_.kind = BallJoint{};
  EXPECT_EQ(coordinate_of(joint_), std::nullopt);
  joint_.kind = FixedJoint{};
  EXPECT_EQ(coordinate_of(joint_), std::nullopt);
  joint_.kind = SpringJoint{};
  EXPECT_EQ(coordinate_of(joint_), std::nullopt);
}

}  // namespace
}  // namespace aurasim::core
