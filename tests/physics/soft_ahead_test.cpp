// The soft step with physics.continuous: contacts ahead of time.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

Settings ahead(bool on = true) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = on;
  return settings;
}

/// A box of 1 cm thickness stands upright at x = 0; a ball of 0.1 m comes at 60 m/s, a metre in a step.
core::Scene thin_wall_and_ball() {
  core::Scene scene = scene_of(core::Sphere{0.1});
  scene.materials[0] = {};
  scene.gravity = core::Vec3::Zero();
  scene.shapes.push_back({"wall", core::Box{core::Vec3(0.005, 2, 2)}});
  scene.statics.clear();
  core::StaticBody wall;
  wall.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  scene.statics.push_back(wall);
  return scene;
}

TEST(SoftAhead, AFastBallDoesNotPassThroughAThinWall) {
  const core::Scene scene = thin_wall_and_ball();
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {-2.3, 0.2, 0}, {60, 0, 0})});
  run(world, 10);
  EXPECT_NEAR(world.records()[0].p_WB.x(), -0.105, 0.005);
  EXPECT_NEAR(world.records()[0].v_WB.x(), 0, 0.01);

  RegionWorld without(scene, ahead(false));
  without.add(std::vector{body(1, 0, {-2.3, 0.2, 0}, {60, 0, 0})});
  run(without, 10);
  EXPECT_GT(without.records()[0].p_WB.x(), 1);
}

TEST(SoftAhead, WhatPassesByIsNotTouched) {
  const core::Scene scene = thin_wall_and_ball();
  RegionWorld world(scene, ahead());
  const core::Vec3 p(-2.3, 2.2, 0), v(60, 0, 0);  // past the edge, at 0.1 m from it
  world.add(std::vector{body(1, 0, p, v)});
  run(world, 10);
  EXPECT_LT((world.records()[0].p_WB - (p + v * 10 / 60)).norm(), 1e-4);
}

/// Two boxes at 20 m/s against each other, which Bullet's algorithm for boxes does not see before they overlap.
TEST(SoftAhead, BoxesMeetBeforeTheyOverlap) {
  core::Scene scene = scene_of(core::Box{});
  scene.materials[0] = {};
  scene.gravity = core::Vec3::Zero();
  scene.statics.clear();
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {-2.01, 0, 0}, {20, 0, 0}), body(2, 0, {2.01, 0, 0}, {-20, 0, 0})});
  double deepest_m = 0;
  std::size_t collisions = 0;
  for (int i = 0; i < 20; ++i) {
    world.step();
    collisions += world.collisions().size();
    deepest_m = std::max(deepest_m, 1 - (world.records()[1].p_WB - world.records()[0].p_WB).x());
  }
  EXPECT_LT(deepest_m, 0.02);
  EXPECT_EQ(collisions, 1U);
  const core::Vec3 momentum = world.records()[0].v_WB + world.records()[1].v_WB;
  EXPECT_LT(momentum.norm(), 1e-5);
}

/// Energy: what is lost in a bounce is what a material says, also of the fall within a step.
TEST(SoftAhead, ABallThatLosesNothingComesBackUp) {
  core::Scene scene = scene_of(core::Sphere{0.25});
  scene.materials[0] = {};
  scene.materials[0].restitution = 1;
  RegionWorld world(scene, ahead());
  world.add(std::vector{body(1, 0, {0, 0, 1.25})});
  double energy = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step();
    const core::BodyRecord& ball = world.records()[0];
    energy = 0.5 * ball.v_WB.squaredNorm() + 9.81 * (ball.p_WB.z() - 0.25);
  }
  EXPECT_NEAR(energy / 9.81, 1, 0.01);
}

}  // namespace
}  // namespace aurasim::physics::testing
