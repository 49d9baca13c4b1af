// Every kind of joint does what it says, in one world.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::JointSpec;
using core::Vec3;

class Joints : public ::testing::TestWithParam<Solver> {
 protected:
  core::InitialBody& place(int kind, const Vec3& p_WB) { return place_body(scene, kind, p_WB); }
  JointSpec& join(core::JointKind kind, std::uint64_t a, std::optional<std::uint64_t> b, const Vec3& p_WJ,
                  const Vec3& axis = Vec3::UnitZ()) {
    return add_joint(scene, std::move(kind), a, b, p_WJ, axis);
  }

  void run_steps(int steps) {
    if (!world) {
      Settings settings;
      settings.solver = GetParam();
      world.emplace(scene, settings);
      world->add(initial_records(scene));
    }
    run(*world, steps);
  }

  /// The value in the next steps that is farthest to that side.
  template <class Value>
  double farthest(double side, int steps, Value&& value) {
    double result = 0;
    for (int i = 0; i < steps; ++i) {
      run_steps(1);
      result = side * std::max(side * result, side * value());
    }
    return result;
  }

  const core::BodyRecord& body(std::size_t i) { return world->records()[i]; }

  /// Where a point of the world in state 0 has gone with body i.
  Vec3 carried(std::size_t i, const Vec3& p_W) {
    const core::Pose& start = scene.bodies[i].pose;
    return body(i).p_WB + body(i).R_WB * (start.q_WB.conjugate() * (p_W - start.p_WB));
  }

  core::Scene scene = scene_of_all_shapes();
  std::optional<RegionWorld> world;
};

TEST_P(Joints, ABallJointHoldsTwoPointsTogether) {
  place(kBox, {0, 0, 5});
  place(kCapsule, {0.5, 0, 4}).v_WB = {3, 4, 0};
  join(core::BallJoint{}, 0, 1, {0.2, 0, 4.5});
  for (int i = 0; i < 200; ++i) {
    run_steps(1);
    ASSERT_LT((carried(0, {0.2, 0, 4.5}) - carried(1, {0.2, 0, 4.5})).norm(), 0.05) << "in state " << i + 1;
  }
}

TEST_P(Joints, AWithoutBHangsFromTheWorld) {
  place(kBox, {1, 0, 5});
  join(core::BallJoint{}, 0, {}, {0, 0, 5});
  double lowest = 5;
  for (int i = 0; i < 120; ++i) {
    run_steps(1);
    ASSERT_LT((carried(0, {0, 0, 5}) - Vec3(0, 0, 5)).norm(), 0.01);
    lowest = std::min(lowest, body(0).p_WB.z());
  }
  EXPECT_NEAR(lowest, 4, 0.05) << "it swings";
}

TEST_P(Joints, AHingeTurnsAboutItsAxisOnly) {
  place(kBox, {0, 0, 5});
  place(kBox, {1.2, 0, 5}).w_WB = {3, 3, 3};
  join(core::HingeJoint{}, 0, 1, {0.6, 0, 5}, Vec3::UnitY());
  for (int i = 0; i < 30; ++i) {
    run_steps(1);
    ASSERT_GT((body(0).R_WB * Vec3::UnitY()).dot(body(1).R_WB * Vec3::UnitY()), 0.999);
    ASSERT_LT((carried(0, {0.6, 0, 5}) - carried(1, {0.6, 0, 5})).norm(), 0.05);
  }
}

double turn_about_z(const core::BodyRecord& body) { return std::atan2(body.R_WB(1, 0), body.R_WB(0, 0)); }

TEST_P(Joints, AMotorTurnsAAtItsSpeed) {
  place(kBox, {0, 0, 5});
  join(core::HingeJoint{{}, core::JointMotor{2, 10}}, 0, {}, {0, 0, 5});
  run_steps(30);
  EXPECT_NEAR(body(0).w_WB.z(), 2, 1e-3);
  EXPECT_NEAR(turn_about_z(body(0)), 1, 0.05);
}

TEST_P(Joints, AMotorWithTooSmallAnImpulseIsSlow) {
  place(kBox, {0, 0, 5});
  join(core::HingeJoint{{}, core::JointMotor{2, 1e-5}}, 0, {}, {0, 0, 5});
  run_steps(30);
  EXPECT_LT(body(0).w_WB.z(), 0.5);
}

TEST_P(Joints, AMotorIsAsStrongInAnySubsteps) {
  place(kBox, {0, 0, 5});
  join(core::HingeJoint{{}, core::JointMotor{1000, 1e-3}}, 0, {}, {0, 0, 5});
  std::vector<double> speeds;
  for (const int substeps : {2, 4, 8}) {
    Settings settings;
    settings.solver = GetParam();
    settings.substeps = substeps;
    world.emplace(scene, settings);
    world->add(initial_records(scene));
    run_steps(30);
    speeds.push_back(body(0).w_WB.z());
    EXPECT_GT(speeds.back(), 0.1);
    EXPECT_LT(speeds.back(), 900);
    EXPECT_NEAR(speeds.back() / speeds.front(), 1, 0.01) << substeps << " substeps";
  }
}

TEST_P(Joints, AHingeStopsAtItsLimits) {
  for (const double side : {1.0, -1.0}) {
    scene = scene_of_all_shapes();
    world.reset();
    place(kBox, {0, 0, 5}).w_WB = {0, 0, 6 * side};
    join(core::HingeJoint{core::JointLimits{-0.25, 0.75}, {}}, 0, {}, {0, 0, 5});
    EXPECT_NEAR(farthest(side, 60, [&] { return turn_about_z(body(0)); }), side > 0 ? 0.75 : -0.25, 0.05);
  }
}

TEST_P(Joints, ASliderSlidesBetweenItsLimits) {
  for (const double side : {1.0, -1.0}) {
    scene = scene_of_all_shapes();
    world.reset();
    place(kBox, {0, 0, 5}).v_WB = {3 * side, 0, 0};
    join(core::SliderJoint{core::JointLimits{-0.5, 1}}, 0, {}, {0, 0, 5}, Vec3::UnitX());
    run_steps(10);
    EXPECT_GT(body(0).p_WB.x() * side, 0.3);
    EXPECT_NEAR(farthest(side, 110, [&] { return body(0).p_WB.x(); }), side > 0 ? 1 : -0.5, 0.05);
    EXPECT_NEAR(body(0).p_WB.z(), 5, 0.01) << "and not across";
    EXPECT_LT((body(0).R_WB - core::Mat3::Identity()).norm(), 0.01) << "and does not turn";
  }
}

TEST_P(Joints, AFixedJointMakesOneBodyOfTwo) {
  place(kBox, {0, 0, 3}).w_WB = {2, 1, 0};
  place(kSphere, {1.5, 0, 3});
  join(core::FixedJoint{}, 0, 1, {0.7, 0, 3});
  for (int i = 0; i < 200; ++i) {
    run_steps(1);
    ASSERT_LT((carried(0, {0.7, 0, 3}) - carried(1, {0.7, 0, 3})).norm(), 0.05);
    ASSERT_LT((body(0).R_WB - body(1).R_WB).norm(), 0.1);
  }
}

TEST_P(Joints, ASpringSwingsWithItsOwnFrequency) {
  scene.gravity.setZero();
  scene.materials[0].linear_damping = 0;
  place(kSphere, {0, 0, 5}).v_WB = {1, 0, 0};
  core::SpringJoint spring;
  spring.axes[0].stiffness = 4 * std::numbers::pi * std::numbers::pi;  // 1 kg: 1 Hz
  for (const std::size_t locked : {1u, 2u, 3u, 4u, 5u}) spring.axes[locked].limits = core::JointLimits{0, 0};
  add_joint(scene, spring, 0, {}, {0, 0, 5}, Vec3::UnitZ());
  run_steps(15);
  EXPECT_NEAR(body(0).p_WB.x(), 1 / (2 * std::numbers::pi), 0.02) << "after a quarter of a second";
  run_steps(15);
  EXPECT_NEAR(body(0).p_WB.x(), 0, 0.02);
  EXPECT_NEAR(body(0).v_WB.x(), -1, 0.1);
}

TEST_P(Joints, ASpringIsHeldByItsLimitsAndMeasuresA) {
  place(kBox, {0, 0, 5}).v_WB = {0, 2, 0};
  core::SpringJoint spring;
  for (core::SpringAxis& axis : spring.axes) axis.limits = core::JointLimits{0, 0};
  spring.axes[1].limits = core::JointLimits{-0.25, 0.5};
  add_joint(scene, spring, 0, {}, {0, 0, 5}, Vec3::UnitZ());
  run_steps(60);
  EXPECT_NEAR(body(0).p_WB.y(), 0.5, 0.05);
  EXPECT_NEAR(body(0).p_WB.z(), 5, 0.02);
}

TEST_P(Joints, ASpringTurnsBetweenItsLimits) {
  for (const std::size_t about : {0u, 1u, 2u}) {
    for (const double side : {1.0, -1.0}) {
      scene = scene_of_all_shapes();
      world.reset();
      place(kBox, {0, 0, 5}).w_WB[static_cast<int>(about)] = 4 * side;
      core::SpringJoint spring;
      for (core::SpringAxis& axis : spring.axes) axis.limits = core::JointLimits{0, 0};
      spring.axes[3 + about].limits = core::JointLimits{-0.25, 0.75};
      add_joint(scene, spring, 0, {}, {0, 0, 5}, Vec3::UnitZ());
      const auto angle = [&] {
        const core::Mat3& R = body(0).R_WB;
        const auto i = static_cast<int>((about + 1) % 3), k = static_cast<int>((about + 2) % 3);
        return std::atan2(R(k, i), R(i, i));
      };
      EXPECT_NEAR(farthest(side, 60, angle), side > 0 ? 0.75 : -0.25, 0.05) << "about axis " << about;
    }
  }
}

TEST_P(Joints, ASpringPullsBackWhatIsTurned) {
  scene.gravity.setZero();
  scene.materials[0].angular_damping = 0;
  place(kSphere, {0, 0, 5}).w_WB = {0, 1, 0};
  core::SpringJoint spring;
  for (core::SpringAxis& axis : spring.axes) axis.limits = core::JointLimits{0, 0};
  spring.axes[4].limits.reset();
  spring.axes[4].stiffness = 1;
  add_joint(scene, spring, 0, {}, {0, 0, 5}, Vec3::UnitZ());
  double largest = 0;
  for (int i = 0; i < 60; ++i) {
    run_steps(1);
    largest = std::max(largest, std::abs(body(0).R_WB(0, 2)));
  }
  const double inertia = 0.4 * 0.4 * 0.4;  // of 1 kg
  EXPECT_NEAR(largest, std::sin(std::sqrt(inertia)), 0.02);
}

TEST_P(Joints, JointedBodiesOnlyCollideWhereTheSceneSaysSo) {
  for (const bool collide : {false, true}) {
    scene = scene_of_all_shapes();
    world.reset();
    place(kBox, {0, 0, 0.45});
    place(kBox, {0.3, 0, 0.45});
    join(core::SliderJoint{}, 1, 0, {0, 0, 0.45}, Vec3::UnitX()).collide = collide;
    run_steps(100);
    EXPECT_EQ(body(1).p_WB.x() - body(0).p_WB.x() > 0.5, collide) << "pushed apart";
  }
}

TEST_P(Joints, AJointThatTakesTooMuchBreaksForGood) {
  place(kBox, {0, 0, 20});
  place(kBox, {3, 0, 0.45});
  join(core::BallJoint{}, 0, {}, {0, 0, 20}).break_impulse = 9.81 / 240 * 0.9;
  join(core::BallJoint{}, 1, {}, {3, 0, 0.45}).break_impulse = 9.81 / 240 * 1.1;
  run_steps(1);
  const auto values = world->peek(std::vector{BodyId{0}, BodyId{1}}).joint_values;
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[2], 0);
  run_steps(59);
  EXPECT_LT(body(0).p_WB.z(), 16);
}

TEST_P(Joints, ASpringThatPullsTooHardBreaks) {
  scene.gravity.setZero();
  for (const bool strong : {true, false}) {
    world.reset();
    scene.bodies.clear(), scene.joints.clear();
    place(kSphere, {0, 0, 5}).v_WB = {20, 0, 0};
    core::SpringJoint spring;
    spring.axes[0].stiffness = 1000;
    join(spring, 0, {}, {0, 0, 5}).break_impulse = strong ? 1e3 : 0.5;  // at most 20 sqrt(1000) / 240 = 2.6
    run_steps(60);
    EXPECT_EQ(world->peek(std::vector{BodyId{0}}).joint_values[0], strong ? 0 : 1);
  }
}

/// Whose halves have left since, at once and as two clusters.
TEST_P(Joints, OneThatBrokeIsWholeAgainWhenTheWorldGoesBack) {
  place(kBox, {0, 0, 20});
  place(kBox, {0, 0, 18});
  join(core::BallJoint{}, 0, {}, {0, 0, 20});
  join(core::BallJoint{}, 0, 1, {0, 0, 19}).break_impulse = 9.81 / 240 * 0.9;
  run_steps(0);
  const core::ClusterState start = world->peek_all();
  run_steps(1);
  EXPECT_EQ(world->peek_all().joint_values[2], 1);
  const std::vector upper{BodyId{0}}, lower{BodyId{1}};
  world->release(std::vector<std::span<const BodyId>>{upper, lower});
  world->put_back(0, start);
  EXPECT_EQ(world->peek_all().joint_values[2], 0);
}

TEST_P(Joints, JointedBodiesFallAsleepTogetherAndWakeTogether) {
  place(kBox, {0, 0, 0.45});
  place(kBox, {3, 0, 0.45});
  place(kSphere, {20, 0, 0.4}).v_WB = {-12, 0, 0};
  join(core::BallJoint{}, 0, 1, {1.5, 0, 0.45});
  for (int i = 0; i < 400; ++i) {
    run_steps(1);
    const auto& bodies = world->snapshot().bodies;
    ASSERT_EQ(bodies[0].awake, bodies[1].awake) << "in state " << i + 1;
    if (i == 399) {
      EXPECT_FALSE(bodies[0].awake);
    }
  }
}

TEST_P(Joints, TheSnapshotNamesPairsAndNotTheWorld) {
  for (int i = 0; i < 3; ++i) place(kBox, {2.0 * i, 0, 5});
  join(core::BallJoint{}, 2, 1, {3, 0, 5});
  join(core::BallJoint{}, 0, 1, {1, 0, 5});
  join(core::BallJoint{}, 0, {}, {0, 0, 5});
  run_steps(1);
  const auto& joints = world->snapshot().joints;
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(std::pair(joints[0].a, joints[0].b), std::pair(0u, 1u));
  EXPECT_EQ(std::pair(joints[1].a, joints[1].b), std::pair(1u, 2u));
}

TEST_P(Joints, ToABodyThatTheSceneDoesNotHaveOrToItselfAreRefused) {
  place(kBox, {0, 0, 5});
  join(core::BallJoint{}, 0, 1, {0, 0, 5});
  EXPECT_THROW(RegionWorld(scene, Settings{}), std::invalid_argument);
  scene.joints[0].b = BodyId{0};
  EXPECT_THROW(RegionWorld(scene, Settings{}), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Of, Joints, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                         [](const auto& solver) { return solver.param == Solver::kSoftStep ? "SoftStep" : "Bullet"; });

}  // namespace
}  // namespace aurasim::physics::testing
