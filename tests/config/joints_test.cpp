#include <cmath>
#include <numbers>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

/// Two named bodies and a row of three up to line 8, then `rest` from line 9 on.
std::string with_bodies(const std::string& rest) {
  return R"(prototypes:
  rod: {shape: {capsule: {radius: 0.1, height: 0.6}}, mass: 1}
bodies:
  - {prototype: rod, name: left, position: [1, 2, 3], id: 7}
  - {prototype: rod, position: [4, 2, 3]}
  - {prototype: rod, name: right, position: [2, 2, 3]}
generators:
  - row: {prototype: rod, count: 3, step: [1, 0, 0], name: rods}
)" + rest;
}

core::JointSpec joint(const std::string& text) {
  const Workspace workspace;
  return workspace.scene(with_bodies("joints: [" + text + "]\n")).joints.at(0);
}

TEST(JointsInAScene, BindNamedBodiesAndBodiesOfGenerators) {
  const core::JointSpec ball = joint("{ball: {}, bodies: [left, rods.2], name: hip, position: [5, 6, 7]}");
  EXPECT_EQ(ball.name, "hip");
  EXPECT_EQ(ball.a, core::BodyId{7});
  EXPECT_EQ(ball.b, core::BodyId{4});
  EXPECT_EQ(ball.X_WJ.p_WB, core::Vec3(5, 6, 7));
  EXPECT_FALSE(ball.collide);
  EXPECT_TRUE(std::isinf(ball.break_impulse));
}

TEST(JointsInAScene, OfOneBodyHoldOnToTheWorldAtItsPlace) {
  const core::JointSpec fixed = joint("{fixed: {}, bodies: [left], collide: true, break_impulse: 2}");
  EXPECT_FALSE(fixed.b.has_value());
  EXPECT_EQ(fixed.X_WJ.p_WB, core::Vec3(1, 2, 3));
  EXPECT_TRUE(fixed.collide);
  EXPECT_EQ(fixed.break_impulse, 2);
}

TEST(JointsInAScene, HingesTurnAboutTheirAxis) {
  const core::JointSpec spec =
      joint("{hinge: {axis: [0, 2, 0], limits_deg: [-90, 45], motor: {speed: 3, max_impulse: 4}}, bodies: [left]}");
  EXPECT_TRUE((spec.X_WJ.q_WB * core::Vec3::UnitZ()).isApprox(core::Vec3::UnitY()));
  const auto& hinge = std::get<core::HingeJoint>(spec.kind);
  EXPECT_DOUBLE_EQ(hinge.limits->low, -std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(hinge.limits->high, std::numbers::pi / 4);
  EXPECT_EQ(hinge.motor->speed, 3);
  EXPECT_EQ(hinge.motor->max_impulse, 4);
}

TEST(JointsInAScene, SlidersHaveLimitsInMetres) {
  const core::JointSpec spec = joint("{slider: {axis: [1, 0, 0], limits: [-1, 2]}, bodies: [left, right]}");
  EXPECT_EQ(std::get<core::SliderJoint>(spec.kind).limits->high, 2);
}

TEST(JointsInAScene, HingesAreDrivenAndResist) {
  const core::JointSpec spec = joint(
      "{hinge: {limits_deg: [none, 900], stiffness: 1, rest_deg: 90, damping: 2, friction: 3, drive: {position_deg: "
      "180, "
      "speed: 4, stiffness: 5, damping: 6, effort: -7, max_effort: 8}}, bodies: [left]}");
  const auto& hinge = std::get<core::HingeJoint>(spec.kind);
  EXPECT_TRUE(std::isinf(hinge.limits->low));
  EXPECT_DOUBLE_EQ(hinge.limits->high, 5 * std::numbers::pi);
  EXPECT_EQ(hinge.resistance, (core::JointResistance{1, std::numbers::pi / 2, 2, 3}));
  EXPECT_EQ(hinge.drive, (core::JointDrive{std::numbers::pi, 4, 5, 6, -7, 8}));
}

TEST(JointsInAScene, SlidersAreDrivenAndResist) {
  const core::JointSpec spec = joint(
      "{slider: {limits: [0, none], stiffness: 1, rest: 0.5, damping: 2, friction: 3, drive: {position: 4}}, bodies: "
      "[left]}");
  const auto& slider = std::get<core::SliderJoint>(spec.kind);
  EXPECT_EQ(slider.limits->low, 0);
  EXPECT_TRUE(std::isinf(slider.limits->high));
  EXPECT_EQ(slider.resistance, (core::JointResistance{1, 0.5, 2, 3}));
  EXPECT_EQ(slider.drive, core::JointDrive{.position = 4});
}

TEST(JointsInAScene, FollowOthersOfTheirMechanismAlsoBeforeThoseAreRead) {
  const Workspace workspace;
  const std::string drive = "drive: {stiffness: 1}";
  const auto joints = workspace
                          .scene(with_bodies("joints:\n  - {slider: {" + drive +
                                             ", follows: {joint: wheel, ratio: -0.5}}, bodies: [left, rods.1]}\n"
                                             "  - {ball: {}, bodies: [rods.1, right]}\n"
                                             "  - {hinge: {" +
                                             drive + ", follows: {joint: joint 0}}, bodies: [right], name: wheel}\n"))
                          .joints;
  EXPECT_EQ(core::coupling_of(joints[0].kind)->leader, core::JointId{2});
  EXPECT_EQ(core::coupling_of(joints[0].kind)->ratio, -0.5);
  EXPECT_EQ(core::coupling_of(joints[2].kind)->leader, core::JointId{0});
  EXPECT_EQ(core::coupling_of(joints[2].kind)->ratio, 1);
}

TEST(JointsInAScene, BallsAreDamped) {
  EXPECT_EQ(std::get<core::BallJoint>(joint("{ball: {damping: 2}, bodies: [left]}").kind).damping, 2);
}

TEST(JointsInAScene, LimitsOnNoSideAreNone) {
  const core::JointSpec spec = joint("{slider: {limits: [none, none]}, bodies: [left]}");
  EXPECT_FALSE(std::get<core::SliderJoint>(spec.kind).limits);
}

TEST(JointsInAScene, SpringsLockWhatTheyDoNotName) {
  const core::JointSpec spec = joint(
      "{spring: {x: {stiffness: 5, damping: 6, rest: 7}, y: {}, rz: {limits_deg: [0, 180]}}, bodies: [left, right]}");
  const auto& axes = std::get<core::SpringJoint>(spec.kind).axes;
  EXPECT_EQ(axes[0].stiffness, 5);
  EXPECT_EQ(axes[0].damping, 6);
  EXPECT_EQ(axes[0].rest, 7);
  EXPECT_FALSE(axes[0].limits.has_value());
  EXPECT_FALSE(axes[1].limits.has_value());
  EXPECT_EQ(axes[2].limits->high, 0);
  EXPECT_EQ(axes[4].limits->low, 0);
  EXPECT_DOUBLE_EQ(axes[5].limits->high, std::numbers::pi);
}

TEST(JointsInAScene, AChainHangsTogetherAndFromTheWorld) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(with_bodies(
      "  - chain: {prototype: rod, count: 3, step: [0.8, 0, 0], position: [0, 0, 9], yaw_deg: 90, anchor: both}\n"
      "joints: [{ball: {}, bodies: [left]}]\n"));
  ASSERT_EQ(scene.joints.size(), 5u);
  const auto expect_joint = [&](std::size_t i, std::uint64_t a, std::optional<core::BodyId> b, double y) {
    EXPECT_EQ(value_of(scene.joints[i].a), a);
    EXPECT_EQ(scene.joints[i].b, b);
    EXPECT_LT((scene.joints[i].X_WJ.p_WB - core::Vec3(0, y, 9)).norm(), 1e-12) << scene.joints[i].X_WJ.p_WB;
  };
  expect_joint(0, 5, {}, -0.4);
  expect_joint(1, 5, core::BodyId{6}, 0.4);
  expect_joint(2, 6, core::BodyId{8}, 1.2);
  expect_joint(3, 8, {}, 2.0);
  const core::InitialBody& link = *core::find_body(scene, core::BodyId{6});
  EXPECT_TRUE((link.pose.q_WB * core::Vec3::UnitZ()).isApprox(core::Vec3::UnitY())) << "links lie along the chain";
  EXPECT_LT((link.pose.p_WB - core::Vec3(0, 0.8, 9)).norm(), 1e-12);
}

const std::vector<BadCase> kBadJoints = {
    {"UnknownBody",
     with_bodies("joints:\n  - {ball: {}, bodies: [left, nobody]}\n"),
     {"scene.yaml:10:31: joints[0].bodies[1]: found \"nobody\", allowed: a named body of this scene: left, right, "
      "rods.0"}},
    {"UnknownKind",
     with_bodies("joints:\n  - {glue: {}, bodies: [left, right]}\n"),
     {"scene.yaml:10:5: joints[0]: found a map of 2, allowed: one of ball, hinge, slider, fixed, spring",
      "scene.yaml:10:6: joints[0].glue: unknown key, allowed: ball, hinge, slider, fixed, spring, bodies"}},
    {"TwoKinds",
     with_bodies("joints:\n  - {ball: {}, fixed: {}, bodies: [left, right]}\n"),
     {"scene.yaml:10:5: joints[0]: found a map of 3, allowed: one of ball"}},
    {"SameBodyTwice",
     with_bodies("joints:\n  - {ball: {}, bodies: [left, left]}\n"),
     {"scene.yaml:10:24: joints[0].bodies: found the same body twice, allowed: two bodies, or one"}},
    {"ThreeBodies",
     with_bodies("joints:\n  - {ball: {}, bodies: [left, right, rods.0]}\n"),
     {"scene.yaml:10:24: joints[0].bodies: found a list of 3, allowed: a list of 1 to 2"}},
    {"NoBodies",
     with_bodies("joints:\n  - {ball: {}}\n"),
     {"scene.yaml:10:5: joints[0].bodies: missing, allowed: a list of 1 to 2"}},
    {"AxisOfNoLength",
     with_bodies("joints:\n  - {hinge: {axis: [0, 0, 0]}, bodies: [left, right]}\n"),
     {"scene.yaml:10:20: joints[0].hinge.axis: found an axis of length 0, allowed: [x, y, z] that can be normalised"}},
    {"AxisOfTwo",
     with_bodies("joints:\n  - {slider: {axis: [0, 1]}, bodies: [left, right]}\n"),
     {"scene.yaml:10:21: joints[0].slider.axis: found a list of 2, allowed: a list of 3"}},
    {"LimitsTheWrongWayRound",
     with_bodies("joints:\n  - {hinge: {limits_deg: [5, -5]}, bodies: [left, right]}\n"),
     {"scene.yaml:10:26: joints[0].hinge.limits_deg: found a list of 2, allowed: [low, high]"}},
    {"LimitsBeyondAThousandTurns",
     with_bodies("joints:\n  - {hinge: {limits_deg: [0, 1e6]}, bodies: [left, right]}\n"),
     {"scene.yaml:10:30: joints[0].hinge.limits_deg[1]: found \"1e6\", allowed: a number from -360000 to 360000"}},
    {"LimitsOfOneSide",
     with_bodies("joints:\n  - {slider: {limits: [1]}, bodies: [left, right]}\n"),
     {"scene.yaml:10:23: joints[0].slider.limits: found a list of 1, allowed: a list of 2 to 2"}},
    {"SpringTurnsBeyondATurn",
     with_bodies("joints:\n  - {spring: {rz: {limits_deg: [0, 190]}}, bodies: [left, right]}\n"),
     {"scene.yaml:10:36: joints[0].spring.rz.limits_deg[1]: found \"190\", allowed: a number from -180 to 180"}},
    {"MotorBesideADrive",
     with_bodies("joints:\n  - {hinge: {motor: {speed: 1, max_impulse: 1}, drive: {}}, bodies: [left]}\n"),
     {"scene.yaml:10:21: joints[0].hinge.motor: found a motor beside a drive, allowed: one of them"}},
    {"DriveThatPushesBack",
     with_bodies("joints:\n  - {slider: {drive: {stiffness: -1, max_effort: -2}}, bodies: [left]}\n"),
     {"scene.yaml:10:34: joints[0].slider.drive.stiffness: found \"-1\", allowed: a number from 0",
      "scene.yaml:10:50: joints[0].slider.drive.max_effort: found \"-2\", allowed: a number from 0"}},
    {"SliderWithADriveInDegrees",
     with_bodies("joints:\n  - {slider: {drive: {position_deg: 1}}, bodies: [left]}\n"),
     {"scene.yaml:10:23: joints[0].slider.drive.position_deg: unknown key"}},
    {"FollowerWithoutADrive",
     with_bodies("joints:\n  - {hinge: {follows: {joint: b}}, bodies: [left, right]}\n"
                 "  - {slider: {}, bodies: [left], name: b}\n"),
     {"scene.yaml:10:23: joints[0].hinge.follows: found no drive beside it, allowed: `follows` of a joint with a "
      "drive"}},
    {"FollowerOfNobody",
     with_bodies("joints:\n  - {hinge: {drive: {}, follows: {joint: b}}, bodies: [left, right], name: a}\n"),
     {"scene.yaml:10:42: joints[0].hinge.follows.joint: found \"b\", allowed: a joint of this scene: a"}},
    {"FollowerOfItself",
     with_bodies("joints:\n  - {hinge: {drive: {}, follows: {joint: a}}, bodies: [left, right], name: a}\n"),
     {"scene.yaml:10:42: joints[0].hinge.follows.joint: found the joint itself, allowed: another one"}},
    {"FollowerOfABall",
     with_bodies("joints:\n  - {hinge: {drive: {}, follows: {joint: b}}, bodies: [left, right]}\n"
                 "  - {ball: {}, bodies: [left], name: b}\n"),
     {"scene.yaml:10:42: joints[0].hinge.follows.joint: found a joint of another kind, allowed: a hinge or slider"}},
    {"FollowerOfWhatHangsFromTheWorldToo",
     with_bodies("joints:\n  - {hinge: {drive: {}, follows: {joint: b}}, bodies: [left]}\n"
                 "  - {hinge: {}, bodies: [right], name: b}\n"),
     {"scene.yaml:10:42: joints[0].hinge.follows.joint: found a joint of something else, allowed: one that a chain of "
      "joints binds to this one"}},
    {"MotorWithoutStrength",
     with_bodies("joints:\n  - {hinge: {motor: {speed: 1}}, bodies: [left]}\n"),
     {"scene.yaml:10:21: joints[0].hinge.motor.max_impulse: missing, allowed: a number from 0"}},
    {"NegativeStiffness",
     with_bodies("joints:\n  - {spring: {x: {stiffness: -1}}, bodies: [left]}\n"),
     {"scene.yaml:10:30: joints[0].spring.x.stiffness: found \"-1\", allowed: a number from 0"}},
    {"BreaksAtOnce",
     with_bodies("joints:\n  - {ball: {}, bodies: [left], break_impulse: 0}\n"),
     {"scene.yaml:10:47: joints[0].break_impulse: found \"0\", allowed: a number above 0"}},
    {"SameBodyNameTwice",
     with_bodies("  - stack: {prototype: rod, count: 1, name: rods}\n"),
     {"scene.yaml:9:12: generators[1].stack: found the name \"rods.0\" a second time, allowed: each name once"}},
};

class BadJoint : public testing::TestWithParam<BadCase> {};

TEST_P(BadJoint, IsRefusedWithPlaceFieldAndReason) {
  const Workspace workspace;
  expect_errors(workspace.scene_errors(GetParam().text), GetParam().errors);
}

INSTANTIATE_TEST_SUITE_P(All, BadJoint, testing::ValuesIn(kBadJoints),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace aurasim::config
