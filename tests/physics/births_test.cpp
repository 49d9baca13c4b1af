#include <gtest/gtest.h>

#include "physics/scenes.h"
#include "physics/state_hash.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::Step;

constexpr Step kBirth = 5;

class Births : public ::testing::Test {
 protected:
  Births() {
    newborn = body(7, kSphere, {0, 0, 10}, {1, 2, 3});
    newborn.birth = kBirth;
    newborn.block = {0, 0};
    world.add(std::span(&newborn, 1));
  }

  core::Scene scene = scene_of_all_shapes();
  RegionWorld world{scene, Settings{}};
  BodyRecord newborn;
};

TEST_F(Births, UntilItsBirthABodyWaitsAsItWillBeBorn) {
  for (Step step = 0; step <= kBirth; ++step) {
    ASSERT_EQ(world.step_number(), step);
    ASSERT_EQ(world.snapshot().bodies.size(), 1u);
    const core::BodyState& state = world.snapshot().bodies[0];
    EXPECT_EQ(state.birth, kBirth);
    EXPECT_EQ(state.pose.p_WB, newborn.p_WB);
    EXPECT_EQ(state.v_WB, newborn.v_WB);
    world.step();
  }
}

TEST_F(Births, ABodyTakesPartInComputingTheStateAfterItsBirth) {
  run(world, kBirth);
  EXPECT_EQ(world.snapshot().bodies[0].pose.p_WB, newborn.p_WB);
  world.step();
  EXPECT_NE(world.snapshot().bodies[0].pose.p_WB, newborn.p_WB);
}

TEST_F(Births, RecordsLeaveOutTheUnborn) {
  run(world, kBirth - 1);
  EXPECT_TRUE(world.records().empty());
  world.step();
  ASSERT_EQ(world.records().size(), 1u);
  EXPECT_EQ(state_hash(world.records()[0]), state_hash(newborn));
}

TEST_F(Births, ABodyThatComesAfterItsBirthIsThereAtOnce) {
  run(world, kBirth);
  BodyRecord late = body(8, kSphere, {5, 0, 10});
  late.birth = kBirth;
  world.add(std::span(&late, 1));
  EXPECT_EQ(world.records().size(), 2u);
}

TEST_F(Births, AnUnbornBodyCanBeHandedOver) {
  RegionWorld other(scene, Settings{});
  run(world, 2);
  run(other, 2);
  const core::ClusterState cluster = world.release(std::vector{newborn.id});
  EXPECT_EQ(world.body_count(), 0u);
  other.adopt(cluster, 2);
  run(other, 1);
  EXPECT_TRUE(other.records().empty());
  run(other, 2);
  ASSERT_EQ(other.records().size(), 1u);
  EXPECT_EQ(state_hash(other.records()[0]), state_hash(newborn));
}

TEST_F(Births, ABodyMayBeBornWhileItsClusterCatchesUp) {
  RegionWorld other(scene, Settings{});
  run(other, kBirth + 2);
  run(world, kBirth - 2);
  std::vector<std::size_t> born;
  other.adopt(world.peek(std::vector{newborn.id}), kBirth - 2,
              [&](Step, auto bodies) { born.push_back(bodies.size()); });
  EXPECT_EQ(born, (std::vector<std::size_t>{0, 1, 1, 1}));
  run(world, 4);
  EXPECT_EQ(different(other.records(), world.records()), std::vector<std::uint64_t>());
}

TEST_F(Births, AnUnbornBodyTouchesNothing) {
  const BodyRecord in_the_way = body(1, kSphere, newborn.p_WB + core::Vec3(0.3, 0, 0));
  world.add(std::span(&in_the_way, 1));
  run(world, kBirth);
  EXPECT_TRUE(world.snapshot().contacts.empty());
  EXPECT_TRUE(world.collisions().empty());
}

}  // namespace
}  // namespace aurasim::physics::testing
