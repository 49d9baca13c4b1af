// What sticks stays, what slides slides as far as the steps say, what rolls rolls on.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

/// Bodies of `shape` that never sleep on ground of the same material; `friction` is that of the pair.
core::Scene scene_with(const core::Shape& shape, double friction) {
  core::Scene scene = scene_of(shape);
  scene.gravity = {0, 0, -kGravity};
  scene.materials[0] = {};
  scene.materials[0].friction = std::sqrt(friction);  // Bullet multiplies the two
  scene.prototypes[0].can_sleep = false;
  return scene;
}

Settings settings_of(int step_hz, int friction_directions) {
  Settings settings;
  settings.step_s = 1.0 / step_hz;
  settings.substeps = 1;
  settings.friction_directions = friction_directions;
  return settings;
}

class Sliding : public ::testing::TestWithParam<std::tuple<int, int>> {
 protected:
  int step_hz_ = std::get<0>(GetParam());
  double step_s_ = 1.0 / step_hz_;
  Settings settings_ = settings_of(step_hz_, std::get<1>(GetParam()));
};

/// Speed goes before place, so the way is the sum of the speeds after each step: v0 dt / 2 short of v0^2 / (2 mu g).
TEST_P(Sliding, ABoxStopsWhereItsStepsSay) {
  constexpr double kFriction = 0.25, kSpeed = 5;
  const core::Scene scene = scene_with(core::Box{{0.5, 0.5, 0.25}}, kFriction);
  RegionWorld world(scene, settings_);
  world.add(std::vector{body(1, 0, {0, 0, 0.25}, {kSpeed, 0, 0})});
  run(world, 3 * step_hz_);
  double way = 0;
  for (double v = kSpeed - kFriction * kGravity * step_s_; v > 0; v -= kFriction * kGravity * step_s_) {
    way += v * step_s_;
  }
  EXPECT_NEAR(world.records()[0].p_WB.x(), way, 2e-3);
  EXPECT_NEAR(world.records()[0].p_WB.z(), 0.25, 1e-3);
}

/// On a slope that gravity makes: a t (t + dt) / 2.
TEST_P(Sliding, ABoxGoesDownASlopeAsItsStepsSay) {
  constexpr double kFriction = 0.25, kSlope = std::numbers::pi / 6;
  core::Scene scene = scene_with(core::Box{{0.5, 0.5, 0.25}}, kFriction);
  scene.gravity = kGravity * Vec3(std::sin(kSlope), 0, -std::cos(kSlope));
  RegionWorld world(scene, settings_);
  world.add(std::vector{body(1, 0, {0, 0, 0.25})});
  run(world, 2 * step_hz_);
  const double acceleration = kGravity * (std::sin(kSlope) - kFriction * std::cos(kSlope));
  EXPECT_NEAR(world.records()[0].p_WB.x(), acceleration * 2 * (2 + step_s_) / 2, 2e-3);
}

/// What a contact remembers of its way does not hold a ball.
TEST_P(Sliding, ABallRollsOn) {
  const core::Scene scene = scene_with(core::Sphere{0.5}, 0.8);
  RegionWorld world(scene, settings_);
  core::BodyRecord ball = body(1, 0, {0, 0, 0.5}, {0.3, 0, 0});
  ball.w_WB = {0, 0.6, 0};
  world.add(std::vector{ball});
  run(world, 5 * step_hz_);
  EXPECT_NEAR(world.records()[0].v_WB.x(), 0.3, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Steps, Sliding, ::testing::Combine(::testing::Values(60, 240), ::testing::Values(1, 2)),
                         [](const auto& param) {
                           return std::to_string(std::get<0>(param.param)) + "HzDirections" +
                                  std::to_string(std::get<1>(param.param));
                         });

/// 100 kg on five cubes of 1 kg, all awake: contacts that look at speeds only walk away from under it within a minute,
/// by what the solver leaves over in each substep.
TEST(Sticking, AHeavyCubeOnLightOnesStandsForAMinute) {
  core::Scene scene = scene_with(core::Box{{0.5, 0.5, 0.5}}, 0.36);
  scene.prototypes.push_back(scene.prototypes[0]);
  scene.prototypes[1].mass_kg = 100;
  Settings settings;
  settings.solver_iterations = 20;
  settings.friction_directions = 2;
  RegionWorld world(scene, settings);
  std::vector<core::BodyRecord> pile;
  for (int i = 0; i < 6; ++i) pile.push_back(body(static_cast<std::uint64_t>(i + 1), i == 5, {0.1, 0, 0.5 + i}));
  world.add(pile);
  run(world, 3600);
  for (std::size_t i = 0; i < pile.size(); ++i) {
    EXPECT_LT((world.records()[i].p_WB - pile[i].p_WB).norm(), 0.1) << "cube " << i;
  }
}

/// A box that has slid is not drawn back to where it was.
TEST(Sticking, WhatHasSlidStaysWhereItStopped) {
  const core::Scene scene = scene_with(core::Box{{0.5, 0.5, 0.5}}, 0.4);
  Settings settings;
  settings.friction_directions = 2;
  RegionWorld world(scene, settings);
  world.add(std::vector{body(1, 0, {0, 0, 0.5}, {3, 1, 0})});
  run(world, 120);
  const Vec3 stopped = world.records()[0].p_WB;
  run(world, 300);
  EXPECT_GT(stopped.x(), 1);
  EXPECT_LT((world.records()[0].p_WB - stopped).norm(), 1e-4);
}

}  // namespace
}  // namespace aurasim::physics::testing
