// What a scene says about materials, gravity and sleep, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

class Materials : public ::testing::Test {
 protected:
  Materials() {
    scene = scene_of(core::Box{{0.5, 0.5, 0.25}});
    scene.materials[0] = core::Material{};
  }

  core::BodyState after(int steps, const core::BodyRecord& start) {
    RegionWorld world(scene, Settings{});
    world.add(std::span(&start, 1));
    run(world, steps);
    return world.snapshot().bodies[0];
  }

  core::Scene scene;
};

TEST_F(Materials, FreeFallIsThatOfSmallSteps) {
  const int substeps = 4 * 60;  // 1 s; semi-implicit Euler falls g t^2 (1 + 1/n) / 2
  const core::BodyState state = after(60, body(1, 0, {0, 0, 100}));
  EXPECT_NEAR(state.v_WB.z(), -9.81, 1e-4);
  EXPECT_NEAR(state.pose.p_WB.z(), 100 - 9.81 / 2 * (1 + 1.0 / substeps), 1e-3);
}

TEST_F(Materials, GravityIsTheScenes) {
  scene.gravity = {0, 2, 0};
  const core::BodyState state = after(60, body(1, 0, {0, 0, 100}));
  EXPECT_LT((state.v_WB - Vec3(0, 2, 0)).norm(), 1e-4);
}

/// Bullet multiplies the two materials' friction.
TEST_F(Materials, ABoxSlidesAsFarAsFrictionLetsIt) {
  scene.materials[0].friction = 0.6;
  const double way = 3.0 * 3.0 / (2 * 0.36 * 9.81);
  const core::BodyState state = after(180, body(1, 0, {0, 0, 0.25}, {3, 0, 0}));
  EXPECT_NEAR(state.pose.p_WB.x(), way, 0.03 * way);
}

TEST_F(Materials, DampingTakesItsSharePerSecond) {
  scene.gravity.setZero();
  scene.materials[0].linear_damping = 0.3;
  scene.materials[0].angular_damping = 0.6;
  core::BodyRecord start = body(1, 0, {0, 0, 100}, {2, 0, 0});
  start.w_WB = {0, 0, 5};
  const core::BodyState state = after(60, start);
  EXPECT_NEAR(state.v_WB.x(), 2 * 0.7, 1e-4);
  EXPECT_NEAR(state.w_WB.z(), 5 * 0.4, 1e-4);
}

/// To a tenth: Bullet acts while there is still a gap, and the largest speed is read at the end of a step.
TEST_F(Materials, RestitutionThrowsBack) {
  scene.materials[0].restitution = 0.9;  // 0.81 of the pair
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, 0, {0, 0, 1.25})});
  double upwards = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    upwards = std::max(upwards, world.snapshot().bodies[0].v_WB.z());
  }
  const double expected = 0.81 * std::sqrt(2 * 9.81 * 1);
  EXPECT_NEAR(upwards, expected, 0.12 * expected);
}

TEST_F(Materials, ABodyThatMayNotSleepStaysAwake) {
  EXPECT_FALSE(after(400, body(1, 0, {0, 0, 0.25})).awake);
  scene.prototypes[0].can_sleep = false;
  EXPECT_TRUE(after(400, body(1, 0, {0, 0, 0.25})).awake);
}

/// Without restitution the two would go on together at 1 m/s; Bullet's push out of the overlap adds up to a fifth of
/// the impact (its error reduction per substep).
TEST_F(Materials, MassDecidesWhoIsPushed) {
  scene.gravity.setZero();
  scene.prototypes.push_back(scene.prototypes[0]);
  scene.prototypes[1].mass_kg = 9;
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, 0, {0, 0, 50}, {10, 0, 0}), body(2, 1, {2, 0, 50})});
  run(world, 30);
  const double light = world.snapshot().bodies[0].v_WB.x(), heavy = world.snapshot().bodies[1].v_WB.x();
  EXPECT_NEAR(1 * light + 9 * heavy, 10, 1e-3);
  EXPECT_GE(heavy - light, -1e-3);
  EXPECT_LT(heavy - light, 2);
}

}  // namespace
}  // namespace aurasim::physics::testing
