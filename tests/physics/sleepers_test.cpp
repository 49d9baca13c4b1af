// What the soft step remembers of sleepers must never show: a world that has just forgotten it does the same.
#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

Settings settings(double block_m = core::kUsualBlock_m) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  settings.block_m = block_m;
  return settings;
}

/// A step with a sleeper that comes and goes, far from all others: what is known of sleepers has to be found out anew.
void step_and_forget(RegionWorld& world) {
  core::BodyRecord stranger = body(1'000'000, kBox, {1000, 1000, 0.5});
  stranger.activation_state = 2;
  world.add({&stranger, 1});
  world.step();
  const core::BodyId id = stranger.id;
  world.release({&id, 1});
}

std::size_t count_sleepers(RegionWorld& world) {
  std::size_t sleepers = 0;
  for (const core::BodyState& body : world.snapshot().bodies) sleepers += body.awake ? 0 : 1;
  return sleepers;
}

TEST(Sleepers, WhatIsRememberedOfThemNeverShows) {
  std::size_t most_sleepers = 0, woken = 0, collisions = 0;
  for (int seed = 0; seed < 30; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    core::Scene scene = scene_of_all_shapes();
    const std::vector<core::BodyRecord> bodies = piles_of_all_shapes(scene, random);
    const Settings with = settings(seed % 2 == 0 ? core::kUsualBlock_m : 2);
    RegionWorld remembers(scene, with), forgets(scene, with);
    for (RegionWorld* world : {&remembers, &forgets}) world->add(bodies);
    std::size_t before = 0;
    for (int n = 1; n <= 900; ++n) {
      if (n > 300 && n % 50 == 0) {
        const core::Vec3 J_W(uniform(random, -4, 4), uniform(random, -4, 4), uniform(random, 0, 6));
        const auto number = static_cast<std::uint64_t>(n);
        const core::Order order{number, 0, n, core::Impulse{core::BodyId{random() % bodies.size()}, J_W}};
        for (RegionWorld* world : {&remembers, &forgets}) world->schedule(order);
      }
      remembers.step();
      step_and_forget(forgets);
      ASSERT_TRUE(different(remembers.records(), forgets.records()).empty()) << "seed " << seed << ", state " << n;
      ASSERT_EQ(remembers.collisions().size(), forgets.collisions().size()) << "seed " << seed << ", state " << n;
      const std::size_t sleepers = count_sleepers(remembers);
      ASSERT_EQ(sleepers, count_sleepers(forgets)) << "seed " << seed << ", state " << n;
      most_sleepers = std::max(most_sleepers, sleepers);
      if (sleepers < before) ++woken;
      before = sleepers;
      collisions += remembers.collisions().size();
    }
  }
  EXPECT_GT(most_sleepers, 50U);
  EXPECT_GT(woken, 20U);
  EXPECT_GT(collisions, 1000U);
}

/// Of the first two.
bool only_the_first_wakes(RegionWorld& world, int steps) {
  bool first = false, second = false;
  for (int i = 0; i < steps; ++i) {
    world.step();
    first = first || world.snapshot().bodies[0].awake;
    second = second || world.snapshot().bodies[1].awake;
  }
  return first && !second;
}

/// Three boxes on each other that have fallen asleep.
class SleepingStack : public ::testing::Test {
 protected:
  void SetUp() override {
    world.add(boxes);
    run(world, 400);
    ASSERT_EQ(count_sleepers(world), boxes.size());
  }

  const core::Scene scene = scene_of_all_shapes();
  const std::vector<core::BodyRecord> boxes = stack(0, 3, 0, 0);
  RegionWorld world{scene, settings()};
};

TEST_F(SleepingStack, IsNotWokenByWhomItNoLongerTouches) {
  world.release({&boxes[1].id, 1});
  const core::BodyRecord ball = body(3, kSphere, {-1.1, 0, 0.5}, {2, 0, 0});
  world.add({&ball, 1});
  EXPECT_TRUE(only_the_first_wakes(world, 20));
}

/// Two that fall asleep just before they would meet are not one island.
TEST(Sleepers, WhoHaveNotMetDoNotWakeEachOther) {
  core::Scene scene = scene_of(core::Sphere{0.5});
  scene.gravity.setZero();
  int just_before = 0;
  for (int i = 0; i < 40; ++i) {
    RegionWorld world(scene, settings());
    const double x = 1.94 + 0.0005 * i;
    const core::Vec3 v(0.75, 0, 0);
    const std::vector<core::BodyRecord> balls = {body(0, 0, {-x, 0, 5}, v), body(1, 0, {x, 0, 5}, -v)};
    world.add(balls);
    run(world, 150);
    if (count_sleepers(world) < 2 || !world.snapshot().contacts.empty()) continue;
    if (world.records()[1].p_WB.x() < 0.511) ++just_before;
    const core::BodyRecord third = body(2, 0, world.records()[0].p_WB + core::Vec3(0, 1.1, 0), {0, -1, 0});
    world.add({&third, 1});
    EXPECT_TRUE(only_the_first_wakes(world, 20)) << i;
  }
  EXPECT_GT(just_before, 0);
}

TEST_F(SleepingStack, WakesWhenWhatItLeansOnGoes) {
  world.schedule({1, 0, world.step_number() + 1, core::RemoveBody{boxes[0].id}});
  run(world, 120);
  ASSERT_EQ(world.records().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(world.records()[i].p_WB.z(), boxes[i].p_WB.z(), 0.02);
}

}  // namespace
}  // namespace aurasim::physics::testing
