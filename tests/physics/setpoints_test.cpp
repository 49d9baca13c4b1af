// What setpoints make of bodies, in every solver; and that their path is the same whichever world computes it.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::Quantity;
using core::Step;
using core::Vec3;

constexpr BodyId kBody{1};

class Pushed : public ::testing::TestWithParam<Solver> {
 protected:
  Pushed() {
    settings.solver = GetParam();
    settings.top_speed_m_s = 40;
    for (core::Material& material : scene.materials) material.linear_damping = material.angular_damping = 0;
  }

  void say(RegionWorld& world, Step at, Quantity quantity, std::optional<Vec3> value) {
    world.controls().recall({core::kRecordedClient, ++said, 0, at, {{kBody, quantity, std::move(value)}}, {}});
  }
  const core::BodyRecord& now(RegionWorld& world) { return world.records().front(); }

  core::Scene scene = scene_of_all_shapes();
  Settings settings;
  std::uint64_t said = 0;
};

TEST_P(Pushed, ABodyHoversUnderItsOwnWeight) {
  RegionWorld world(scene, settings);
  const core::BodyRecord box = body(1, kBox, {0, 0, 5});
  world.add({&box, 1});
  say(world, 1, Quantity::kForce, Vec3(0, 0, 9.81));
  run(world, 120);
  EXPECT_NEAR(now(world).p_WB.z(), 5, 1e-5);
  EXPECT_NEAR(now(world).v_WB.norm(), 0, 1e-5);
}

TEST_P(Pushed, AForceAccelerates) {
  scene.gravity = Vec3::Zero();
  RegionWorld world(scene, settings);
  const core::BodyRecord box = body(1, kBox, {0, 0, 5});
  world.add({&box, 1});
  say(world, 11, Quantity::kForce, Vec3(3, 0, 0));
  say(world, 71, Quantity::kForce, std::nullopt);
  run(world, 10);
  EXPECT_EQ(now(world).v_WB, Vec3::Zero());
  run(world, 60);
  EXPECT_NEAR(now(world).v_WB.x(), 3, 1e-5);
  EXPECT_NEAR(now(world).p_WB.x(), 1.5, 0.03);
  run(world, 60);
  EXPECT_NEAR(now(world).v_WB.x(), 3, 1e-5);
}

TEST_P(Pushed, ATorqueTurns) {
  scene.gravity = Vec3::Zero();
  RegionWorld world(scene, settings);
  const core::BodyRecord ball = body(1, kSphere, {0, 0, 5});
  world.add({&ball, 1});
  const double radius = std::get<core::Sphere>(scene.shapes[kSphere].shape).radius;
  say(world, 1, Quantity::kTorque, Vec3(0, 0, 0.1));
  run(world, 60);
  const double inertia = 0.4 * radius * radius;
  EXPECT_NEAR(now(world).w_WB.z() * inertia, 0.1, 1e-5);
}

TEST_P(Pushed, AVelocityIsHeldAgainstGravity) {
  RegionWorld world(scene, settings);
  const core::BodyRecord box = body(1, kBox, {0, 0, 5});
  world.add({&box, 1});
  say(world, 1, Quantity::kVelocity, Vec3(1, 0, 0));
  say(world, 1, Quantity::kSpin, Vec3(0, 0, 2));
  run(world, 60);
  EXPECT_NEAR(now(world).p_WB.x(), 1, 1e-6);
  EXPECT_NEAR(now(world).w_WB.z(), 2, 1e-6);
  EXPECT_GT(now(world).p_WB.z(), 4.85);
}

TEST_P(Pushed, ABaseDrivesACircleAheadOfItAndStillFalls) {
  RegionWorld world(scene, settings);
  core::BodyRecord box = body(1, kBox, {0, 0, 40});
  box.R_WB = Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()).toRotationMatrix();  // ahead is the world's y
  world.add({&box, 1});
  say(world, 1, Quantity::kDriving, Vec3(1, 0, EIGEN_PI / 2));
  run(world, 60);  // a quarter turn to the left, of radius v / w
  const double radius = 2 / EIGEN_PI;
  EXPECT_NEAR(now(world).p_WB.x(), -radius, 0.03);
  EXPECT_NEAR(now(world).p_WB.y(), radius, 0.03);
  EXPECT_NEAR(now(world).v_WB.z(), -9.81, 0.2);
  EXPECT_NEAR(now(world).w_WB.z(), EIGEN_PI / 2, 1e-5);
  say(world, 61, Quantity::kDriving, Vec3(0, 2, 0));
  run(world, 1);
  EXPECT_NEAR(now(world).v_WB.y(), -2, 0.05);  // its left
}

TEST_P(Pushed, ABaseOnItsEndHasNoAhead) {
  RegionWorld world(scene, settings);
  core::BodyRecord box = body(1, kBox, {0, 0, 40});
  box.R_WB = Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitY()).toRotationMatrix();
  world.add({&box, 1});
  say(world, 1, Quantity::kDriving, Vec3(1, 0, 0));
  run(world, 10);
  EXPECT_NEAR(now(world).v_WB.head<2>().norm(), 0, 1e-6);
}

TEST_P(Pushed, ASleeperWakesUpAndSleepsAgain) {
  RegionWorld world(scene, settings);
  const core::BodyRecord box = body(1, kBox, {0, 0, 0.5});
  world.add({&box, 1});
  run(world, 400);
  ASSERT_EQ(now(world).activation_state, 2);
  const Vec3 before = now(world).p_WB;
  say(world, 401, Quantity::kForce, Vec3(20, 0, 0));
  say(world, 431, Quantity::kForce, std::nullopt);
  run(world, 31);
  EXPECT_GT(now(world).p_WB.x(), before.x() + 0.5);
  run(world, 400);
  EXPECT_EQ(now(world).activation_state, 2);
}

TEST_P(Pushed, WhatNoBodyBearsIsNotObeyed) {
  RegionWorld world(scene, settings), quiet(scene, settings);
  const core::BodyRecord box = body(1, kBox, {0, 0, 5});
  for (RegionWorld* one : {&world, &quiet}) one->add({&box, 1});
  say(world, 1, Quantity::kForce, Vec3(1e9, 0, 0));
  say(world, 1, Quantity::kTorque, Vec3(0, 1e9, 0));
  say(world, 1, Quantity::kVelocity, Vec3(0, 0, 41));
  say(world, 1, Quantity::kSpin, Vec3(0, 0, 1e5));
  run(world, 30);
  run(quiet, 30);
  EXPECT_EQ(world.take_unbearable(), 4u * 30);
  EXPECT_TRUE(different(world.records(), quiet.records()).empty());
}

/// Of two in contact: what a push does goes through contacts, and travels.
TEST_P(Pushed, ThePathIsTheSameInWorldsThatHandItOver) {
  RegionWorld central(scene, settings), first(scene, settings), second(scene, settings);
  const std::vector<core::BodyRecord> bodies = {body(1, kBox, {0, 0, 0.5}), body(2, kBox, {0.2, 0, 1.55})};
  central.add(bodies);
  first.add(bodies);
  for (RegionWorld* world : {&central, &first, &second}) {
    for (Step step = 1; step < 200; step += 2) {
      world->controls().recall({core::kRecordedClient,
                                static_cast<std::uint64_t>(step),
                                0,
                                step,
                                {{kBody, Quantity::kForce, Vec3(6 * std::sin(0.1 * double(step)), 2, 1)},
                                 {kBody, Quantity::kTorque, Vec3(0.3, 0, 0.2 * std::cos(0.2 * double(step)))}},
                                {}});
    }
  }
  RegionWorld *host = &first, *other = &second;
  for (Step n = 1; n <= 200; ++n) {
    run(central, 1), run(first, 1), run(second, 1);
    if (n % 23 == 0) {  // and comes three states late
      const core::ClusterState cluster = host->release(ids_of(bodies));
      run(central, 3), run(first, 3), run(second, 3);
      other->adopt(cluster, n);
      std::swap(host, other);
      n += 3;
    }
    ASSERT_TRUE(different(host->records(), central.records()).empty()) << "state " << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Pushed, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                         [](const auto& param) {
                           return std::string(param.param == Solver::kSoftStep ? "SoftStep" : "SequentialImpulse");
                         });

}  // namespace
}  // namespace aurasim::physics::testing
