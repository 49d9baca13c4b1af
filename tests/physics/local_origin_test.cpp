// Settings::p_WO: Bullet's coordinates may begin elsewhere than the world's.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "physics/region_world.h"
#include "physics/scenes.h"

namespace aurasim::physics {
namespace {

using namespace testing;
using core::BodyRecord;
using core::Vec3;

constexpr double kFar_m = 100'000;
constexpr int kMinute = 3600;

bool is_single() { return RegionWorld::precision() == std::string("single"); }

Settings with_origin(const Vec3& p_WO) {
  Settings settings;
  settings.p_WO = p_WO;
  return settings;
}

/// Largest way of any body of a standing stack in a minute after it has settled for a second, metres.
double drift(double x, const Vec3& p_WO) {
  const core::Scene scene = scene_of_all_shapes();
  RegionWorld world(scene, with_origin(p_WO));
  world.add(stack(1, 5, x, 0));
  run(world, 60);
  const std::vector<BodyRecord> before(world.records().begin(), world.records().end());
  double largest = 0;
  for (int i = 0; i < kMinute; ++i) {
    world.step();
    for (std::size_t b = 0; b < before.size(); ++b) {
      largest = std::max(largest, (world.records()[b].p_WB - before[b].p_WB).norm());
    }
  }
  return largest;
}

TEST(LocalOrigin, AStackFarOutIsAsSteadyAsAtTheOrigin) {
  const double at_origin = drift(0, Vec3::Zero());
  const double far_out = drift(kFar_m, {kFar_m, 0, 0});
  EXPECT_LE(far_out, 1.1 * at_origin + 1e-12);
  RecordProperty("drift_at_origin_m", std::to_string(at_origin));
  RecordProperty("drift_far_out_m", std::to_string(far_out));
}

/// Way of a ball that sets off at 0.5 m/s along x, in a second, metres.
double way_of_a_slow_ball(double x, const Vec3& p_WO) {
  core::Scene scene = scene_of_all_shapes();
  scene.gravity = Vec3::Zero();
  RegionWorld world(scene, with_origin(p_WO));
  const BodyRecord ball = body(1, kSphere, {x, 0, 50}, {0.5, 0, 0});
  world.add({&ball, 1});
  run(world, 60);
  return world.records()[0].p_WB.x() - x;
}

/// Steps of 2 mm are below half of the 7.8 mm between two floats there.
TEST(LocalOrigin, WithoutItSlowBodiesStandStillInSinglePrecision) {
  EXPECT_NEAR(way_of_a_slow_ball(kFar_m, {kFar_m, 0, 0}), way_of_a_slow_ball(0, Vec3::Zero()), 1e-5);
  EXPECT_NEAR(way_of_a_slow_ball(kFar_m, Vec3::Zero()), is_single() ? 0 : way_of_a_slow_ball(0, Vec3::Zero()), 1e-5);
}

TEST(LocalOrigin, CoordinatesComeBackAsTheyWentIn) {
  const core::Scene scene = scene_of_all_shapes();
  RegionWorld world(scene, with_origin({kFar_m, -kFar_m, 0}));
  const BodyRecord there = body(1, kBox, {kFar_m + 3.25, -kFar_m - 0.5, 20.125});
  world.add({&there, 1});
  EXPECT_EQ(world.records()[0].p_WB, there.p_WB);
  EXPECT_EQ(world.snapshot().bodies[0].pose.p_WB, there.p_WB);
}

/// Bodies that settle are handed to a world with another origin, at forty moments: their next step is that of the
/// bodies that stayed. Metres per second.
double kick(const std::vector<BodyRecord>& bodies) {
  const core::Scene scene = scene_of_all_shapes();
  RegionWorld here(scene, with_origin({kFar_m - 16, 0, 0}));
  here.add(bodies);
  double kick = 0;
  for (int i = 0; i < 40; ++i) {
    RegionWorld there(scene, with_origin({kFar_m + 32, 16, 0}));
    run(there, static_cast<int>(here.step_number()));
    there.adopt(here.peek(ids_of(bodies)), here.step_number());
    run(there, 1);
    run(here, 1);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      kick = std::max(kick, (there.records()[b].v_WB - here.records()[b].v_WB).norm());
    }
    run(here, 9);
  }
  return kick;
}

/// In single precision the coordinates themselves are rounded, to 4 um at 48 m from an origin.
TEST(LocalOrigin, AHandOffBetweenDifferentOriginsKicksNobody) {
  std::mt19937_64 random(1);
  const double of_a_stack = kick(stack(1, 5, kFar_m, 0));
  const double of_a_pile = kick(pile(random, 1, 12, kFar_m, 0));
  EXPECT_LT(of_a_stack, is_single() ? 0.05 : 1e-8);
  EXPECT_LT(of_a_pile, is_single() ? 0.05 : 1e-8);
  RecordProperty("stack_m_s", std::to_string(of_a_stack));
  RecordProperty("pile_m_s", std::to_string(of_a_pile));
}

}  // namespace
}  // namespace aurasim::physics
