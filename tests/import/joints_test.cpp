// Several axes as one joint of a scene.
#include "import/joints.h"

#include <limits>

#include "import/imported.h"

namespace aurasim::importing {
namespace {

using core::Vec3;

AxisRule turn(const Vec3& axis, double low = -1, double high = 1) { return {.axis_W = axis, .low = low, .high = high}; }
AxisRule way(const Vec3& axis, double low = -1, double high = 1) {
  return {.axis_W = axis, .turns = false, .low = low, .high = high};
}

class SeveralAxesOfAJoint : public ::testing::Test {
 protected:
  std::optional<SeveralAxes> joined(const std::vector<AxisRule>& rules) {
    return several_axes_kind(rules, "joint", model_);
  }
  Model model_;
};

core::SpringAxis axis_of(const SeveralAxes& joint, std::size_t i) {
  return std::get<core::SpringJoint>(joint.kind).axes[i];
}

TEST_F(SeveralAxesOfAJoint, TwoTurnsAreAboutXAndZ) {
  const auto joint = joined({turn(Vec3::UnitY(), -2, 3), turn(Vec3::UnitZ())});
  ASSERT_TRUE(joint);
  EXPECT_LT(distance(Vec3(joint->q_WJ * Vec3::UnitX()), Vec3::UnitY()), 1e-12);
  EXPECT_LT(distance(Vec3(joint->q_WJ * Vec3::UnitZ()), Vec3::UnitZ()), 1e-12);
  EXPECT_EQ(axis_of(*joint, 3).limits->high, 3);
  EXPECT_EQ(axis_of(*joint, 4).limits->high, 0);
}

TEST_F(SeveralAxesOfAJoint, ALeftHandedThirdTurnIsTurnedOver) {
  const auto joint = joined({turn(Vec3::UnitZ()), turn(Vec3::UnitY()), turn(Vec3::UnitX(), -0.25, 0.75)});
  ASSERT_TRUE(joint);
  EXPECT_LT(distance(Vec3(joint->q_WJ * Vec3::UnitZ()), Vec3(-Vec3::UnitX())), 1e-12);
  EXPECT_EQ(axis_of(*joint, 5).limits->low, -0.75);
  EXPECT_EQ(axis_of(*joint, 5).limits->high, 0.25);
}

TEST_F(SeveralAxesOfAJoint, AWayOfOppositeSignIsTurnedOver) {
  const auto joint =
      joined({way(Vec3::UnitX()), way(-Vec3::UnitY(), -0.25, 0.75), way(Vec3::UnitZ()), turn(Vec3::UnitZ())});
  ASSERT_TRUE(joint);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(axis_of(*joint, i).limits->high > 0);
}

TEST_F(SeveralAxesOfAJoint, AWayAlongTheTurnSharesItsAxis) {
  const auto joint = joined({way(Vec3::UnitZ(), -0.25, 0.75), turn(Vec3::UnitZ())});
  ASSERT_TRUE(joint);
  EXPECT_EQ(axis_of(*joint, 2).limits->high, 0.75);
  EXPECT_EQ(axis_of(*joint, 0).limits->high, 0);
}

TEST_F(SeveralAxesOfAJoint, SkewAxesAndWaysAfterTurnsAreRefused) {
  EXPECT_FALSE(joined({turn(Vec3::UnitX()), turn(Vec3(1, 1, 0))}));
  EXPECT_FALSE(joined({turn(Vec3::UnitX()), way(Vec3::UnitX())}));
  EXPECT_FALSE(joined({way(Vec3(1, 1, 0)), turn(Vec3::UnitX()), turn(Vec3::UnitZ())}));
  EXPECT_FALSE(joined({turn(Vec3::UnitX()), turn(Vec3::UnitY(), -2, 2), turn(Vec3::UnitZ())})) << "past a quarter turn";
}

TEST(Joints, AHingesLimitsMayBeWiderThanATurnOrOnOneSide) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto limits_of = [](const core::JointKind& kind) { return std::get<core::HingeJoint>(kind).limits; };
  EXPECT_EQ(limits_of(one_axis_kind(turn(Vec3::UnitZ(), -7, 8)))->high, 8);
  EXPECT_EQ(limits_of(one_axis_kind(turn(Vec3::UnitZ(), 0, inf)))->high, inf);
  EXPECT_EQ(limits_of(one_axis_kind(turn(Vec3::UnitZ(), -1e5, 1)))->low, -inf) << "farther than a scene can say";
  EXPECT_FALSE(limits_of(one_axis_kind(turn(Vec3::UnitZ(), -inf, inf))));
}

TEST_F(SeveralAxesOfAJoint, LimitsWiderThanATurnAreToldOf) {
  const auto joint = joined({turn(Vec3::UnitX(), -7, 7), turn(Vec3::UnitZ())});
  ASSERT_TRUE(joint);
  EXPECT_FALSE(axis_of(*joint, 3).limits);
  ASSERT_EQ(model_.lost.size(), 1u);
}

TEST_F(SeveralAxesOfAJoint, DrivesBecomeSpringsAndAreToldOfWhereTheyAreMore) {
  AxisRule driven = turn(Vec3::UnitX());
  driven.resistance = {.stiffness = 10, .rest = 0.5, .damping = 1, .friction = 2};
  driven.drive = core::JointDrive{.position = 1, .stiffness = 30, .damping = 2, .max_effort = 5};
  const auto joint = joined({driven, turn(Vec3::UnitZ())});
  ASSERT_TRUE(joint);
  EXPECT_EQ(axis_of(*joint, 3).stiffness, 40);
  EXPECT_EQ(axis_of(*joint, 3).damping, 3);
  EXPECT_DOUBLE_EQ(axis_of(*joint, 3).rest, 35.0 / 40);
  EXPECT_EQ(model_.lost.size(), 2u) << "friction, most effort";
}

TEST(Inertia, PrincipalAxesAreARotationNearToTheAxesThatWere) {
  const core::Quat q(0.9, 0.1, -0.2, 0.15);
  const core::Mat3 R = q.normalized().toRotationMatrix();
  const PrincipalInertia found = principal_inertia(R * Vec3(3, 1, 2).asDiagonal() * R.transpose());
  EXPECT_LT(distance(found.moments, Vec3(3, 1, 2)), 1e-12);
  EXPECT_LT(distance(found.R_LB, R), 1e-12);
}

}  // namespace
}  // namespace aurasim::importing
