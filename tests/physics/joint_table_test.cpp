// Drives that are set while the world runs, and how joints are seen to move.
#include "physics/joint_table.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <gtest/gtest.h>

#include "physics/bullet_convert.h"
#include "physics/joint_scenes.h"
#include "physics/moving_body.h"

namespace aurasim::physics::testing {
namespace {

using core::JointDrive;
using core::JointId;
using std::numbers::pi;

/// Body 0 on a hinge and body 1 on a slider, both along z, to the world; body 2 on a ball joint.
core::Scene scene_of_two() {
  core::Scene scene = scene_of_all_shapes();
  scene.gravity = core::Vec3::Zero();
  for (int i = 0; i < 3; ++i) place_body(scene, kSphere, {2.0 * i, 0, 5});
  add_joint(scene, core::HingeJoint{}, 0, {}, {0, 0, 5});
  add_joint(scene, core::SliderJoint{}, 1, {}, {2, 0, 5});
  add_joint(scene, core::BallJoint{}, 2, {}, {4, 0, 5});
  return scene;
}

class JointTableTest : public ::testing::TestWithParam<Solver> {
 protected:
  static Settings settings() {
    Settings settings;
    settings.solver = GetParam();
    return settings;
  }

  JointTableTest() {
    std::vector<HostedBody> arrivals;
    for (const core::InitialBody& body : scene.bodies) {
      HostedBody hosted;
      hosted.id = body.id, hosted.born = true;
      btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &shape, btVector3(1, 1, 1));
      info.m_startWorldTransform = to_bullet(body.pose);
      hosted.rigid = std::make_unique<MovingBody>(info);
      arrivals.push_back(std::move(hosted));
    }
    bodies.insert(std::move(arrivals));
    for (HostedBody& body : bodies.bodies()) world.insert(*body.rigid, 1 + static_cast<int>(core::value_of(body.id)));
    for (HostedBody& body : bodies.bodies()) joints.connect(body.id, bodies, world);
  }
  ~JointTableTest() override { joints.disconnect(cluster(), bodies, world); }

  core::ClusterState cluster() const {
    core::ClusterState all;
    for (const core::InitialBody& body : scene.bodies) all.bodies.push_back(core::initial_record(body));
    joints.append_to(all);
    return all;
  }
  std::size_t values_of(std::size_t joint) const { return cluster().joints[joint].value_count; }

  void run_steps(int steps) {
    for (int i = 0; i < steps; ++i) {
      for (int look = 0; look < settings().looks(); ++look) {
        world.step(settings().step_s / settings().looks());
        joints.finish_look(world);
      }
    }
  }

  core::Scene scene = scene_of_two();
  btSphereShape shape{btScalar(0.4)};
  BodyTable bodies;
  DynamicsWorld world{scene.gravity, settings()};
  JointTable joints{scene, settings()};
};

TEST_P(JointTableTest, MotionIsThatOfHingesAndSliders) {
  bodies[0].rigid->setAngularVelocity({0, 0, 3});
  bodies[1].rigid->setLinearVelocity({0, 0, 2});
  run_steps(150);
  EXPECT_NEAR(joints.motion(JointId{0})->position, 7.5, 0.01) << "more than a turn";
  EXPECT_NEAR(joints.motion(JointId{0})->speed, 3, 0.01);
  EXPECT_NEAR(joints.motion(JointId{1})->position, 5, 0.01);
  EXPECT_NEAR(joints.motion(JointId{1})->speed, 2, 0.01);
  EXPECT_EQ(joints.motion(JointId{1})->effort, 0);
  EXPECT_FALSE(joints.motion(JointId{2}));
}

TEST_P(JointTableTest, ADriveIsObeyedFromTheNextStepOn) {
  joints.drive(JointId{0}, {.position = -3 * pi, .stiffness = 30, .damping = 10});
  joints.drive(JointId{1}, {.effort = 3});
  run_steps(1);
  EXPECT_NEAR(joints.motion(JointId{1})->effort, 3, 1e-3);
  EXPECT_NEAR(joints.motion(JointId{1})->speed, 3.0 / 60, 1e-3);
  run_steps(400);
  EXPECT_NEAR(joints.motion(JointId{0})->position, -3 * pi, 0.01);
  joints.drive(JointId{0}, {});
  run_steps(1);
  EXPECT_EQ(joints.motion(JointId{0})->effort, 0);
}

TEST_P(JointTableTest, ADriveWakesItsBodiesUnlessItIsTheSameAgain) {
  const JointDrive drive{.speed = 1, .damping = 1};
  for (const bool is_new : {true, false}) {
    bodies[0].rigid->forceActivationState(ISLAND_SLEEPING);
    joints.drive(JointId{0}, drive);
    EXPECT_EQ(bodies[0].rigid->isActive(), is_new);
  }
}

TEST_P(JointTableTest, OnlyWhatIsSetTravels) {
  EXPECT_EQ(values_of(0), 2u);
  joints.drive(JointId{0}, {.effort = 1, .max_effort = 2});
  joints.drive(JointId{2}, {.effort = 1});
  EXPECT_EQ(values_of(0), 10u);
  EXPECT_EQ(values_of(1), 2u);
  EXPECT_EQ(values_of(2), 2u) << "a ball joint has no drive";
  run_steps(600);
  EXPECT_GT(joints.motion(JointId{0})->position, 6 * pi);
  const core::ClusterState state = cluster();
  for (const double value : state.joint_values) EXPECT_TRUE(std::isfinite(value));
  JointTable other(scene, settings());
  other.restore(state, bodies);
  core::ClusterState again;
  again.bodies = state.bodies;
  other.append_to(again);
  again.joint_values[1] = state.joint_values[1];  // the impulse that is reported
  EXPECT_EQ(again.joint_values[2], state.joint_values[2]);
  EXPECT_EQ(again.joint_values.size(), state.joint_values.size());
  EXPECT_TRUE(std::ranges::equal(std::span(again.joint_values).first(10), std::span(state.joint_values).first(10)));
}

TEST_P(JointTableTest, WhatIsNoNumberIsBounded) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  joints.drive(JointId{0}, {nan, 1e300, -1e300, nan, nan, nan});
  run_steps(10);
  const core::ClusterState state = cluster();
  for (const double value : state.joint_values) EXPECT_LE(std::abs(value), 1e12);
}

INSTANTIATE_TEST_SUITE_P(Solvers, JointTableTest, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep));

}  // namespace
}  // namespace aurasim::physics::testing
