#include <algorithm>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::Step;

class FirstContact : public ::testing::Test {
 protected:
  FirstContact() { scene.gravity.setZero(); }

  /// Two balls of 0.4 m that meet in x = 0 at a closing speed of 6 m/s. They stay together: no restitution.
  std::vector<BodyRecord> head_on() const {
    return {body(1, kSphere, {-1, 0, 5}, {3, 0, 0}), body(2, kSphere, {1, 0, 5}, {-3, 0, 0})};
  }

  std::vector<Collision> run_and_collect(RegionWorld& world, int steps) {
    std::vector<Collision> all;
    for (int i = 0; i < steps; ++i) {
      world.step();
      all.insert(all.end(), world.collisions().begin(), world.collisions().end());
    }
    return all;
  }

  core::Scene scene = scene_of_all_shapes();
};

TEST_F(FirstContact, IsReportedOnceWithWhatWasBeforeTheSolver) {
  RegionWorld world(scene, Settings{});
  world.add(head_on());
  const std::vector<Collision> seen = run_and_collect(world, 60);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].a, BodyId{1});
  EXPECT_EQ(seen[0].b, BodyId{2});
  EXPECT_EQ(seen[0].step, 13);                       // 0.6 m each at 3 m/s: 0.2 s, and a little for the damping
  EXPECT_NEAR(seen[0].relative_speed_m_s, 6, 0.1);   // less what damping took
  EXPECT_NEAR(seen[0].penetration_m, 0, 6.0 / 240);  // a substep's way
  EXPECT_NEAR(seen[0].p_W.x(), 0, 1e-6);
  EXPECT_NEAR(seen[0].p_W.z(), 5, 1e-6);
}

TEST_F(FirstContact, TellsHowDeepTheBodiesAre) {
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, kSphere, {0, 0, 5}), body(2, kSphere, {0.7, 0, 5})});
  const std::vector<Collision> seen = run_and_collect(world, 1);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_NEAR(seen[0].penetration_m, 0.1, 1e-6);
  EXPECT_EQ(seen[0].relative_speed_m_s, 0);
}

TEST_F(FirstContact, OfSpinningBodiesCountsTheSpeedAtTheContact) {
  RegionWorld world(scene, Settings{});
  std::vector<BodyRecord> balls = {body(1, kSphere, {0, 0, 5}), body(2, kSphere, {0.79, 0, 5})};
  balls[0].w_WB = {0, 0, 10};  // its skin moves at 4 m/s
  world.add(balls);
  const std::vector<Collision> seen = run_and_collect(world, 1);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_NEAR(seen[0].relative_speed_m_s, 4, 0.1);
}

TEST_F(FirstContact, IsReportedAgainAfterTheBodiesHaveParted) {
  RegionWorld world(scene, Settings{});
  world.add(head_on());
  run(world, 30);
  std::vector<BodyRecord> apart = head_on();
  world.release(ids_of(apart));
  world.add(apart);
  EXPECT_EQ(run_and_collect(world, 60).size(), 1u);
}

TEST_F(FirstContact, WithTheGroundIsNoCollision) {
  scene.gravity = {0, 0, -9.81};
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, kBox, {0, 0, 1})});
  EXPECT_TRUE(run_and_collect(world, 60).empty());
  EXPECT_FALSE(world.peek(std::vector{BodyId{1}}).manifolds.empty());
}

TEST_F(FirstContact, ThatCameWithAHandOffIsNotNew) {
  RegionWorld first(scene, Settings{}), second(scene, Settings{});
  first.add(head_on());
  run(first, 13);
  run(second, 13);
  ASSERT_EQ(first.snapshot().contacts.size(), 1u);
  second.adopt(first.release(ids_of(head_on())), 13);
  EXPECT_TRUE(run_and_collect(second, 30).empty());
}

TEST_F(FirstContact, DuringACatchUpIsReportedWithTheNextStep) {
  RegionWorld first(scene, Settings{}), second(scene, Settings{});
  first.add(head_on());
  run(first, 10);
  run(second, 14);
  second.adopt(first.release(ids_of(head_on())), 10);
  second.step();
  ASSERT_EQ(second.collisions().size(), 1u);
  EXPECT_EQ(second.collisions()[0].step, 13);
  EXPECT_TRUE(run_and_collect(second, 30).empty());
}

TEST_F(FirstContact, OfCompoundsIsOneHoweverManyPartsTouch) {
  RegionWorld world(scene, Settings{});
  std::vector<BodyRecord> hammers = {body(1, kCompound, {0, 0, 5}), body(2, kCompound, {0, 0.199, 5})};
  hammers[0].v_WB = {0, 2, 0};  // flat on each other: both boxes of one touch those of the other, and so do the balls
  world.add(hammers);
  world.step();
  ASSERT_EQ(world.collisions().size(), 1u);
  EXPECT_NEAR(world.collisions()[0].penetration_m, 0.201, 0.02) << "of the balls";
  EXPECT_NEAR(world.collisions()[0].relative_speed_m_s, 2, 0.1);
  std::size_t between_the_two = 0;
  for (const core::ManifoldRecord& manifold : world.peek(ids_of(hammers)).manifolds) {
    between_the_two += manifold.object0 > 0 && manifold.object1 > 0;
  }
  EXPECT_GE(between_the_two, 3u);
}

TEST_F(FirstContact, OfAnotherPartOfACompoundIsNotNew) {
  RegionWorld world(scene, Settings{});
  std::vector<BodyRecord> hammers = {body(1, kCompound, {0, 0, 5}), body(2, kCompound, {0, 0.41, 5}, {0, -0.5, 0})};
  world.add(hammers);
  const std::vector<Collision> seen = run_and_collect(world, 20);
  EXPECT_EQ(seen.size(), 1u);
}

TEST_F(FirstContact, OfSleepersIsNotRepeatedWhenTheyWake) {
  scene.gravity = {0, 0, -9.81};
  RegionWorld world(scene, Settings{});
  world.add(stack(1, 3, 0, 0));
  EXPECT_EQ(run_and_collect(world, 400).size(), 2u);
  ASSERT_FALSE(world.snapshot().bodies[0].awake);
  world.add(std::vector{body(9, kBox, {0, 0, 4})});
  const std::vector<Collision> seen = run_and_collect(world, 100);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].a, BodyId{3});
  EXPECT_EQ(seen[0].b, BodyId{9});
}

TEST_F(FirstContact, ListsAreInTheOrderOfIds) {
  RegionWorld world(scene, Settings{});
  std::vector<BodyRecord> bodies;
  for (std::uint64_t i = 0; i < 20; ++i) bodies.push_back(body(20 - i, kSphere, {0.79 * static_cast<double>(i), 0, 5}));
  world.add(bodies);
  world.step();
  EXPECT_EQ(world.collisions().size(), 19u);
  EXPECT_TRUE(std::ranges::is_sorted(world.collisions(), {}, [](const auto& c) { return std::pair(c.a, c.b); }));
}

}  // namespace
}  // namespace aurasim::physics::testing
