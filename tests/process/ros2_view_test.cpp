// Bodies and joints as ROS 2 sees them.
#include "process/ros2_view.h"

#include <gmock/gmock.h>

#include "config/workspace.h"

namespace aurasim::process {
namespace {

using core::BodyId;
using core::BodyState;
using core::Pose;
using core::Quat;
using core::Vec3;
using std::chrono::nanoseconds;

constexpr double kTurn = 0.7, kSpin = 1.3, kPi = EIGEN_PI;

Quat about(const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis.normalized())); }

/// J somewhere, askew; a and b as they are at the start, and as they are after a motion of both together.
struct Joined {
  Pose X_WJ{{1, 2, 3}, about({1, 1, 0}, 0.9)};
  Pose a0{{1.5, 2, 3}, about({0, 1, 0}, 0.3)};
  Pose b0{{0, 2, 2.5}, about({1, 0, 2}, -0.8)};
  Pose whole{{-4, 5, 0.5}, about({1, -2, 0.5}, 2.1)};

  static Pose times(const Pose& X, const Pose& Y) { return {X.p_WB + X.q_WB * Y.p_WB, X.q_WB * Y.q_WB}; }
  static Pose inverse(const Pose& X) { return {-(X.q_WB.conjugate() * X.p_WB), X.q_WB.conjugate()}; }
  Pose X_AJ() const { return times(inverse(a0), X_WJ); }
  Pose X_BJ() const { return times(inverse(b0), X_WJ); }
  /// a, after it has moved by `motion` in J and then with all.
  BodyState a(const Pose& motion) const {
    BodyState state;
    state.id = BodyId{1};
    state.pose = times(whole, times(times(X_WJ, motion), inverse(X_AJ())));
    return state;
  }
  BodyState b() const {
    BodyState state;
    state.id = BodyId{2};
    state.pose = times(whole, b0);
    return state;
  }
  Vec3 axis_W() const { return whole.q_WB * (X_WJ.q_WB * Vec3::UnitZ()); }
  Vec3 place_W() const { return whole.p_WB + whole.q_WB * X_WJ.p_WB; }
};

/// As JointRows measures; `b` null: the world.
std::optional<core::JointMotion> motion_of(const core::JointKind& kind, const Pose& X_AJ, const BodyState& a,
                                           const Pose& X_BJ, const BodyState* b) {
  core::JointSpec joint;
  joint.kind = kind;
  const std::optional<int> coordinate = core::coordinate_of(joint);
  if (!coordinate) return std::nullopt;
  return core::joint_motion({X_AJ, X_BJ}, *coordinate, a, b != nullptr ? *b : BodyState{});
}

/// The whole turns by `w` about the world's origin and moves by `v`.
void carry(BodyState& body, const Vec3& v, const Vec3& w) {
  body.v_WB += v + w.cross(body.pose.p_WB);
  body.w_WB += w;
}

TEST(Ros2View, AHingeTurnsFromItsInitialPoseOn) {
  const Joined joined;
  BodyState a = joined.a({Vec3::Zero(), about(Vec3::UnitZ(), kTurn)}), b = joined.b();
  a.w_WB = kSpin * joined.axis_W();
  a.v_WB = a.w_WB.cross(a.pose.p_WB - joined.place_W());
  for (BodyState* body : {&a, &b}) carry(*body, {1, 2, 3}, {0.4, -0.2, 0.9});
  const auto motion = motion_of(core::HingeJoint{}, joined.X_AJ(), a, joined.X_BJ(), &b);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->position, kTurn, 1e-12);
  EXPECT_NEAR(motion->speed, kSpin, 1e-12);
}

TEST(Ros2View, ASliderSlidesFromItsInitialPoseOn) {
  const Joined joined;
  BodyState a = joined.a({{0, 0, kTurn}, Quat::Identity()}), b = joined.b();
  a.v_WB = kSpin * joined.axis_W();
  for (BodyState* body : {&a, &b}) carry(*body, {1, 2, 3}, {0.4, -0.2, 0.9});
  const auto motion = motion_of(core::SliderJoint{}, joined.X_AJ(), a, joined.X_BJ(), &b);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->position, kTurn, 1e-12);
  EXPECT_NEAR(motion->speed, kSpin, 1e-12);
}

TEST(Ros2View, AJointToTheWorldIsMeasuredInIt) {
  Joined joined;
  joined.whole = {};
  for (const double turn : {0.0, kTurn, -3.0, kPi - 0.1}) {
    const BodyState a = joined.a({Vec3::Zero(), about(Vec3::UnitZ(), turn)});
    const auto motion = motion_of(core::HingeJoint{}, joined.X_AJ(), a, joined.X_WJ, nullptr);
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->position, turn, 1e-12);
    EXPECT_EQ(motion->speed, 0);
  }
}

TEST(Ros2View, OtherJointsHaveNoSingleNumber) {
  const Joined joined;
  const BodyState a = joined.a({}), b = joined.b();
  for (const core::JointKind& kind : {core::JointKind(core::BallJoint{}), core::JointKind(core::FixedJoint{}),
                                      core::JointKind(core::SpringJoint{})}) {
    EXPECT_FALSE(motion_of(kind, joined.X_AJ(), a, joined.X_BJ(), &b));
  }
}

TEST(Ros2View, TimeIsThatOfTheStateToTheNanosecond) {
  EXPECT_EQ(ros2_time(0, 60), nanoseconds(0));
  EXPECT_EQ(ros2_time(1, 60), nanoseconds(16'666'667));
  EXPECT_EQ(ros2_time(60, 60), nanoseconds(1'000'000'000));
  EXPECT_EQ(ros2_time(60LL * 86'400 * 365 + 30, 60), nanoseconds(86'400LL * 365 * 1'000'000'000 + 500'000'000));
  EXPECT_EQ(ros2_time(1, 0.5), nanoseconds(2'000'000'000));
}

class SceneForRos : public testing::Test {
 protected:
  SceneForRos() {
    workspace.write("scene.yaml", R"(shapes:
  ball: {sphere: {radius: 0.5}}
prototypes:
  ball: {shape: ball, mass: 1}
bodies:
  - {prototype: ball, name: robot, id: 7, position: [3, 0, 1]}
  - {prototype: ball, id: 3, position: [0, 0, 1]}
  - {prototype: ball, name: wheel, id: 8, position: [3, 0, 2]}
joints:
  - {name: axle, bodies: [wheel, robot], hinge: {}}
  - {name: rail, bodies: [robot], slider: {axis: [1, 0, 0]}}
  - {name: hook, bodies: [wheel, robot], ball: {}}
)");
    launch = config::read_launch(workspace.write("launch.yaml", config::kSmallLaunch));
    snapshot.step = 10;
    for (const core::InitialBody& body : launch.scene.bodies) {
      BodyState state;
      state.id = body.id;
      state.pose = body.pose;
      snapshot.bodies.push_back(state);
    }
    snapshot.joints = {{1, 2}};
  }

  config::Workspace workspace;
  config::Launch launch;
  core::Snapshot snapshot;
};

TEST_F(SceneForRos, FramesHaveTheNamesOfTheFile) {
  const FrameNames names(launch);
  EXPECT_EQ(names.of(BodyId{7}), "robot");
  EXPECT_EQ(names.of(BodyId{3}), "body_3");
  EXPECT_EQ(names.of(BodyId{1'000'000'000}), "body_1000000000");
  EXPECT_EQ(names.body("wheel"), BodyId{8});
  EXPECT_FALSE(names.body("body_3"));
}

TEST_F(SceneForRos, HingesAndSlidersAreToldByName) {
  snapshot.bodies[1].pose.p_WB.x() += 0.25;
  snapshot.bodies[2].pose.p_WB.x() += 0.25;
  snapshot.bodies[1].v_WB = snapshot.bodies[2].v_WB = Vec3(2, 0, 0);
  const dds::Ros2Joints joints = JointRows(launch.scene).in(snapshot);
  EXPECT_THAT(joints.name, testing::ElementsAre("axle", "rail"));
  EXPECT_THAT(joints.position, testing::ElementsAre(0, testing::DoubleNear(0.25, 1e-12)));
  EXPECT_THAT(joints.velocity, testing::ElementsAre(0, testing::DoubleNear(2, 1e-12)));
}

TEST_F(SceneForRos, AJointIsToldWhereItsBodiesAreAndWhileItHolds) {
  const JointRows rows(launch.scene);
  snapshot.joints.clear();  // it has broken
  EXPECT_THAT(rows.in(snapshot).name, testing::ElementsAre("rail"));
  snapshot.bodies.erase(snapshot.bodies.begin() + 1);  // the robot is with another node
  EXPECT_THAT(rows.in(snapshot).name, testing::IsEmpty());
}

}  // namespace
}  // namespace aurasim::process
