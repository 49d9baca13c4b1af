// Lifts, gates, turntables and belts: what stands on them goes along, what is in their way is pushed, and whichever
// world computes it, the bits are the same.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/static_path.h"
#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::PathStop;
using core::Quat;
using core::Step;
using core::Vec3;

class MovingStatics : public ::testing::Test {
 protected:
  MovingStatics() {
    settings.solver = Solver::kSoftStep;
    settings.continuous = true;
    settings.friction_directions = 2;
  }

  void add_box(const Vec3& half_extents, const Vec3& p, std::optional<core::StaticPath> path = {},
               const Vec3& belt_S = Vec3::Zero(), const Quat& q_WB = Quat::Identity()) {
    scene.shapes.push_back({"box", core::Box{half_extents}});
    const auto shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
    scene.statics.push_back({"it", shape, 0, {p, q_WB}, std::move(path), belt_S});
  }
  static PathStop stop(double at_s, const Vec3& p, const Quat& q = Quat::Identity()) { return {at_s, {p, q}}; }
  static Quat yaw(double rad) { return Quat(Eigen::AngleAxisd(rad, Vec3::UnitZ())); }

  core::Scene scene = scene_of_all_shapes();
  Settings settings;
};

TEST_F(MovingStatics, ALiftCarriesWhatStandsOnIt) {
  add_box({2, 2, 0.25}, {0, 0, 0.25}, core::StaticPath{{stop(1, {0, 0, 0}), stop(4, {0, 0, 3})}, false, true});
  RegionWorld world(scene, settings);
  const core::BodyRecord bodies[] = {body(1, kBox, {0, 0, 0.95}), body(2, kSphere, {1, 0, 0.95})};
  world.add(bodies);
  run(world, 60);
  const double box_above = world.records()[0].p_WB.z();
  for (int n = 61; n <= 360; ++n) {
    world.step();
    const double rises = core::pose_at(scene.statics.back(), n / 60.0).p_WB.z() - 0.25;
    ASSERT_NEAR(world.records()[0].p_WB.z() - box_above, rises, 0.01) << n;
  }
  EXPECT_NEAR(world.records()[1].p_WB.z(), world.records()[0].p_WB.z(), 0.2) << "the ball has not fallen off";
  EXPECT_NEAR(world.records()[0].v_WB.norm(), 0, 0.01);
}

TEST_F(MovingStatics, ALiftThatStartsWakesWhatSleepsOnIt) {
  add_box({2, 2, 0.25}, {0, 0, 0.25}, core::StaticPath{{stop(5, {0, 0, 0}), stop(6, {0, 0, 1})}, false, true});
  RegionWorld world(scene, settings);
  const core::BodyRecord bodies[] = {body(1, kBox, {0, 0, 0.95}), body(2, kBox, {9, 0, 0.5})};
  world.add(bodies);
  run(world, 290);
  EXPECT_FALSE(world.snapshot().bodies[1].awake);
  EXPECT_GT(world.snapshot().bodies[0].coming_kick_m_s, 0) << "neighbours are told before it starts";
  EXPECT_EQ(world.snapshot().bodies[1].coming_kick_m_s, 0);
  const double before = world.records()[0].p_WB.z();
  run(world, 100);
  EXPECT_NEAR(world.records()[0].p_WB.z(), before + 1, 0.01);
  EXPECT_FALSE(world.snapshot().bodies[1].awake) << "far away nobody wakes up";
}

TEST_F(MovingStatics, ABeltCarriesAtItsSpeedAlongItself) {
  add_box({10, 1, 0.25}, {0, 0, 0.25}, {}, {1.5, 0, 0}, yaw(std::numbers::pi / 2));
  RegionWorld world(scene, settings);
  const core::BodyRecord crate = body(1, kBox, {0, -8, 0.95});
  world.add({&crate, 1});
  run(world, 180);
  EXPECT_NEAR(world.records()[0].v_WB.y(), 1.5, 0.01);
  EXPECT_NEAR(world.records()[0].v_WB.x(), 0, 0.01);
  const double y = world.records()[0].p_WB.y();
  run(world, 240);
  EXPECT_NEAR(world.records()[0].p_WB.y(), y + 6, 0.05) << "and never falls asleep";
  EXPECT_NEAR(world.records()[0].p_WB.x(), 0, 0.05);
}

TEST_F(MovingStatics, AGatePushesWhatIsInItsWay) {
  add_box({0.1, 3, 1}, {0, 0, 1.05}, core::StaticPath{{stop(2, {4, 0, 0})}, false, false});
  RegionWorld world(scene, settings);
  const core::BodyRecord bodies[] = {body(1, kBox, {2, 0, 0.5}), body(2, kCapsule, {1, 2, 0.9})};
  world.add(bodies);
  for (int n = 1; n <= 120; ++n) {
    world.step();
    const double face = 0.1 + 4 * std::min(1.0, n / 120.0);
    for (const core::BodyRecord& pushed : world.records()) ASSERT_GT(pushed.p_WB.x(), face + 0.2) << n;
  }
  EXPECT_LT(world.records()[0].p_WB.x(), 6);
}

TEST_F(MovingStatics, AFastGateMissesNobody) {
  add_box({0.05, 3, 1}, {-20, 0, 1.05}, core::StaticPath{{stop(0.5, {0, 0, 0}), stop(1, {40, 0, 0})}, false, false});
  RegionWorld world(scene, settings);
  const core::BodyRecord ball = body(1, kSphere, {0, 0, 0.5});
  world.add({&ball, 1});
  run(world, 62);
  EXPECT_GT(world.records()[0].p_WB.x(), 18) << "80 m/s, 1.3 m in a step";
}

TEST_F(MovingStatics, ATurntableTakesWhatLiesOnItRound) {
  scene.shapes.push_back({"disc", core::Cylinder{3, 0.5}});
  core::StaticBody disc;
  disc.name = "disc";
  disc.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  disc.pose.p_WB = {0, 0, 0.25};
  constexpr double kThird = 2 * std::numbers::pi / 3;
  disc.path = {
      {stop(2, Vec3::Zero(), yaw(kThird)), stop(4, Vec3::Zero(), yaw(2 * kThird)), stop(6, Vec3::Zero())}, true, false};
  scene.statics.push_back(disc);
  RegionWorld world(scene, settings);
  const core::BodyRecord crate = body(1, kBox, {1.2, 0, 0.95});
  world.add({&crate, 1});
  run(world, 120);
  const double radius = world.records()[0].p_WB.head<2>().norm();
  EXPECT_NEAR(world.records()[0].v_WB.norm(), kThird / 2 * radius, 0.02);
  EXPECT_NEAR(world.records()[0].w_WB.z(), kThird / 2, 0.02);
  run(world, 240);
  EXPECT_NEAR(world.records()[0].p_WB.head<2>().norm(), radius, 0.05);
}

TEST_F(MovingStatics, RaysMeetThemWhereTheyAre) {
  add_box({1, 1, 0.25}, {0, 0, 5}, core::StaticPath{{stop(1, {0, 0, 4})}, false, false});
  RegionWorld world(scene, settings);
  EXPECT_NEAR(world.cast({0, 0, 20}, {0, 0, 0}).distance_m, 14.75, 1e-3);
  run(world, 30);
  EXPECT_NEAR(world.cast({0, 0, 20}, {0, 0, 0}).distance_m, 12.75, 1e-3);
  run(world, 90);
  EXPECT_NEAR(world.cast({0, 0, 20}, {0, 0, 0}).distance_m, 10.75, 1e-3);
}

TEST_F(MovingStatics, AreNotForOtherSolvers) {
  add_box({1, 1, 1}, {0, 0, 1}, {}, {1, 0, 0});
  settings.solver = Solver::kSequentialImpulse;
  EXPECT_THROW(RegionWorld(scene, settings), std::invalid_argument);
}

/// Some of the bodies are handed to another world on the way, late, and computed up to where that one is.
TEST_F(MovingStatics, HaveTheSameBitsWhoeverComputesThem) {
  add_box({2, 2, 0.25}, {0, 0, 0.2}, core::StaticPath{{stop(0.7, {0, 0, 1}), stop(1.4, {0, 0, 0})}, true, true});
  add_box({0.2, 3, 0.5}, {60, 0, 0.6},
          core::StaticPath{
              {stop(1, Vec3::Zero(), yaw(2)), stop(2, Vec3::Zero(), yaw(4)), stop(3, Vec3::Zero())}, true, false});
  add_box({3, 2, 0.2}, {120, 0, 0.2}, {}, {-2, 1, 0});
  std::mt19937_64 random(3);
  std::vector<core::BodyRecord> all;
  for (const double x : {0.0, 60.0, 120.0}) {
    const std::vector<core::BodyRecord> some = pile(random, all.size() + 1, 8, x, 0);
    all.insert(all.end(), some.begin(), some.end());
  }
  RegionWorld one(scene, settings);
  one.add(all);
  RegionWorld here(scene, settings), there(scene, settings);
  here.add(all);
  const std::vector<core::BodyId> moved = ids_of(std::span(all).subspan(8, 8));
  for (int n = 1; n <= 400; ++n) {
    one.step(), here.step(), there.step();
    if (n == 100) {
      const core::ClusterState cluster = here.release(moved);
      for (int late = 0; late < 7; ++late, ++n) one.step(), here.step(), there.step();
      there.adopt(cluster, 100);
    }
    ASSERT_TRUE(different(here.records(), one.records()).empty()) << n;
    ASSERT_TRUE(different(there.records(), one.records()).empty()) << n;
  }
  EXPECT_EQ(there.body_count(), 8u);
  EXPECT_EQ(here.severed_contacts(), 0u);
}

TEST_F(MovingStatics, GoWhereTheyAreSent) {
  add_box({2, 2, 0.25}, {0, 0, 0.25});
  RegionWorld world(scene, settings);
  const core::BodyRecord crate = body(1, kBox, {0, 0, 0.95});
  world.add({&crate, 1});
  run(world, 200);
  EXPECT_EQ(world.snapshot().bodies[0].coming_kick_m_s, 0);
  const core::StaticId id{static_cast<std::uint32_t>(scene.statics.size() - 1)};
  const core::Pose up{{0, 0, 2.25}, Quat::Identity()};
  world.schedule({1, 1, 210, core::MoveStatic{id, scene.statics.back().pose, up, 60}});
  world.step();
  EXPECT_GT(world.snapshot().bodies[0].coming_kick_m_s, 0) << "neighbours are told before it starts";
  run(world, 139);
  EXPECT_NEAR(world.records()[0].p_WB.z(), 2.95, 0.02);
  EXPECT_NEAR(world.cast({1.5, 0, 20}, {1.5, 0, 0}).distance_m, 17.5, 1e-3);
  run(world, 120);
  EXPECT_NEAR(world.records()[0].p_WB.z(), 2.95, 0.02);
  EXPECT_EQ(world.snapshot().bodies[0].coming_kick_m_s, 0);
}

TEST_F(MovingStatics, GoBackWithTheWorld) {
  add_box({2, 2, 0.25}, {0, 0, 0.2}, core::StaticPath{{stop(0.5, {0, 0, 1}), stop(1, {0, 0, 0})}, true, true});
  std::mt19937_64 random(5);
  const std::vector<core::BodyRecord> all = pile(random, 1, 6, 0, 0);
  RegionWorld world(scene, settings);
  world.add(all);
  run(world, 40);
  const core::ClusterState then = world.peek_all();
  run(world, 50);
  const std::vector<core::BodyRecord> straight(world.records().begin(), world.records().end());
  world.put_back(40, then);
  run(world, 50);
  EXPECT_TRUE(different(world.records(), straight).empty());
}

}  // namespace
}  // namespace aurasim::physics::testing
