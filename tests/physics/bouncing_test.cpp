// Bounces neither make nor lose energy but what restitution takes.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

core::Scene scene_of_bouncing(const core::Shape& shape, double restitution) {
  core::Scene scene = scene_of(shape);
  scene.materials[0] = {};
  scene.materials[0].friction = 0;
  scene.materials[0].restitution = std::sqrt(restitution);  // Bullet multiplies the two
  scene.prototypes[0].can_sleep = false;
  return scene;
}

Settings settings_of(int step_hz) {
  Settings settings;
  settings.step_s = 1.0 / step_hz;
  settings.substeps = 1;
  return settings;
}

/// Of a body of 1 kg above z = 0. What a semi-implicit Euler step keeps: its velocity is half a step ahead.
double energy(const core::BodyRecord& body, double step_s) {
  const double v = body.v_WB.z() - 0.5 * kGravity * step_s;
  return 0.5 * v * v + kGravity * body.p_WB.z();
}

TEST(BouncingBodies, ABallWithRestitutionOneKeepsItsEnergyFor20Seconds) {
  const core::Scene scene = scene_of_bouncing(core::Sphere{0.5}, 1);
  for (const int step_hz : {60, 240, 1000}) {
    RegionWorld world(scene, settings_of(step_hz));
    world.add(std::vector{body(1, 0, {0, 0, 1.5})});
    const double step_s = 1.0 / step_hz;
    const double before = energy(world.records().front(), step_s) - kGravity * 0.5;
    double largest = 0;
    for (int i = 0; i < 20 * step_hz; ++i) {
      world.step();
      const double now = energy(world.records().front(), step_s) - kGravity * 0.5;
      largest = std::max(largest, std::abs(now - before) / before);
    }
    EXPECT_LT(largest, 0.01) << step_hz << " Hz";
  }
}

TEST(BouncingBodies, EachBounceReachesTheSquareOfItsRestitution) {
  const core::Scene scene = scene_of_bouncing(core::Sphere{0.5}, 0.5);
  RegionWorld world(scene, settings_of(240));
  world.add(std::vector{body(1, 0, {0, 0, 1.5})});
  std::vector<double> tops;
  double before = 0;
  for (int i = 0; i < 300; ++i) {
    world.step();
    const core::BodyRecord& ball = world.records().front();
    if (before > 0 && ball.v_WB.z() <= 0) tops.push_back(ball.p_WB.z() - 0.5);
    before = ball.v_WB.z();
  }
  ASSERT_GE(tops.size(), 2u);
  EXPECT_NEAR(tops[0], 0.25, 0.02);
  EXPECT_NEAR(tops[1], 0.0625, 0.02);
}

/// All four corners touch in the same substep, so it does not begin to spin. Were they found one after the other, it
/// would, and make energy.
TEST(BouncingBodies, ABoxThatFallsFlatKeepsItsEnergyAndDoesNotSpin) {
  const core::Scene scene = scene_of_bouncing(core::Box{{0.5, 0.5, 0.5}}, 1);
  for (const int step_hz : {60, 240, 1000}) {
    RegionWorld world(scene, settings_of(step_hz));
    world.add(std::vector{body(1, 0, {0, 0, 1.5})});
    const double before = energy(world.records().front(), 1.0 / step_hz) - kGravity * 0.5;
    double largest = 0;
    for (int i = 0; i < 5 * step_hz; ++i) {
      world.step();
      const core::BodyRecord& box = world.records().front();
      const double now = energy(box, 1.0 / step_hz) - kGravity * 0.5;
      largest = std::max(largest, std::abs(now - before) / before);
      ASSERT_LT(box.w_WB.norm(), 0.05) << step_hz << " Hz, step " << i;
    }
    EXPECT_LT(largest, 0.01) << step_hz << " Hz";
  }
}

TEST(BouncingBodies, TwoBallsThatMeetExchangeTheirVelocities) {
  core::Scene scene = scene_of_bouncing(core::Sphere{0.5}, 1);
  scene.gravity = Vec3::Zero();
  RegionWorld world(scene, settings_of(60));
  world.add(std::vector{body(1, 0, {-3, 0, 5}, {7, 0, 0}), body(2, 0, {3, 0, 5}, {-2, 0, 0})});
  run(world, 90);
  EXPECT_NEAR(world.records()[0].v_WB.x(), -2, 1e-5);
  EXPECT_NEAR(world.records()[1].v_WB.x(), 7, 1e-5);
}

}  // namespace
}  // namespace aurasim::physics::testing
