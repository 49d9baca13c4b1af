// The block of a body, as part of its state.
#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"
#include "physics/state_hash.h"

namespace aurasim::physics::testing {
namespace {

using core::Block;
using core::BodyId;
using core::BodyRecord;
using core::Vec3;

constexpr double kSide = 4;  // so the margin is 0.125 m

Settings small_blocks(Solver solver = Solver::kSoftStep) {
  Settings settings;
  settings.solver = solver;
  settings.block_m = kSide;
  return settings;
}

class Blocks : public ::testing::TestWithParam<Solver> {
 protected:
  Block block_of(RegionWorld& world, std::uint64_t id) {
    const std::vector<BodyId> ids = {BodyId{id}};
    return world.peek(ids).bodies.front().block;
  }

  const Settings settings = small_blocks(GetParam());
  core::Scene scene = scene_of_all_shapes();
};

TEST_P(Blocks, ANewBodyHasTheBlockOfItsCentre) {
  RegionWorld world(scene, settings);
  world.add(std::vector{body(1, kSphere, {0.01, -0.01, 5}), body(2, kSphere, {-7.9, 8.1, 5})});
  EXPECT_EQ(block_of(world, 1), (Block{0, -1}));
  EXPECT_EQ(block_of(world, 2), (Block{-2, 2}));
}

TEST_P(Blocks, ABodyKeepsItsBlockUntilItsCentreIsBeyondTheMargin) {
  RegionWorld world(scene, settings);
  world.add(std::vector{body(1, kSphere, {3, 1, 500}, {3, 0, 0})});
  for (int i = 0; i < 60; ++i) {
    world.step();
    const double x = world.records()[0].p_WB.x();
    EXPECT_EQ(block_of(world, 1), (Block{x > 4.125 ? 1 : 0, 0})) << x;
  }
  EXPECT_GT(world.records()[0].p_WB.x(), 5);
}

TEST_P(Blocks, ABodyOnAnEdgeHasTheBlockThatItHad) {
  RegionWorld world(scene, settings);
  std::vector<BodyRecord> bodies = {body(1, kSphere, {4.1, 1, 0.4}), body(2, kSphere, {3.9, 3, 0.4})};
  bodies[0].block = {0, 0};
  bodies[1].block = {1, 0};
  world.add(bodies);
  run(world, 30);
  EXPECT_EQ(block_of(world, 1), (Block{0, 0}));
  EXPECT_EQ(block_of(world, 2), (Block{1, 0}));
}

/// Balls in a row, jointed one to the next, over three blocks. The ball of the lowest id is the last.
std::vector<BodyRecord> chain(core::Scene& scene) {
  constexpr std::uint64_t kBalls = 12;
  for (std::uint64_t i = 0; i < kBalls; ++i) {
    place_body(scene, kSphere, {11.5 - static_cast<double>(i), 1, 300});
    if (i > 0) add_joint(scene, core::BallJoint{}, i, i - 1, {12 - static_cast<double>(i), 1, 300});
  }
  return initial_records(scene);
}

TEST_P(Blocks, AMechanismHasTheBlockOfItsLowestId) {
  const std::vector<BodyRecord> bodies = chain(scene);
  RegionWorld world(scene, settings);
  world.add(bodies);
  for (const BodyRecord& link : world.records()) EXPECT_EQ(link.block, (Block{2, 0}));
  run(world, 30);
  for (const BodyRecord& link : world.records()) EXPECT_EQ(link.block, (Block{2, 0}));

  core::Order order;
  order.at_step = world.step_number() + 1;
  order.action = core::RemoveBody{BodyId{5}};
  world.schedule(order);
  run(world, 2);
  const std::span<const BodyRecord> left = world.records();
  ASSERT_EQ(left.size(), 11u);
  for (const BodyRecord& link : left) {
    EXPECT_EQ(link.block, (Block{core::value_of(link.id) < 5 ? 2 : 1, 0})) << core::value_of(link.id);
  }
}

TEST_P(Blocks, AMechanismThatBreaksIsSeveral) {
  std::vector<BodyRecord> bodies = chain(scene);
  scene.joints[5].break_impulse = 0;
  RegionWorld world(scene, settings);
  bodies[11].v_WB = {-5, 0, 0};
  world.add(bodies);
  run(world, 30);
  EXPECT_EQ(block_of(world, 0), (Block{2, 0}));
  EXPECT_EQ(block_of(world, 6), block_of(world, 11));
  EXPECT_NE(block_of(world, 6), block_of(world, 0));
}

TEST_P(Blocks, AHandOffAndAPutBackKeepBlocks) {
  const std::vector<BodyRecord> links = chain(scene);
  RegionWorld world(scene, settings), other(scene, settings);
  world.add(links);
  std::vector<BodyRecord> balls = {body(101, kSphere, {4.1, 1, 0.4}), body(102, kSphere, {3.9, 3, 0.4})};
  balls[0].block = {0, 0};
  balls[1].block = {1, 0};
  world.add(balls);
  run(world, 3);
  run(other, 3);
  const core::ClusterState then = world.peek_all();
  std::map<BodyId, Block> blocks;
  for (const BodyRecord& record : then.bodies) blocks[record.id] = record.block;
  EXPECT_EQ(blocks[BodyId{101}], (Block{0, 0}));
  EXPECT_EQ(blocks[BodyId{11}], (Block{2, 0}));

  run(world, 100);
  world.put_back(3, then);
  for (const BodyRecord& record : world.records()) EXPECT_EQ(record.block, blocks[record.id]);
  std::vector<BodyId> ids;
  for (const BodyRecord& record : then.bodies) ids.push_back(record.id);
  other.adopt(world.release(ids), 3);
  for (const BodyRecord& record : other.records()) EXPECT_EQ(record.block, blocks[record.id]);
  EXPECT_EQ(different(other.records(), then.bodies), std::vector<std::uint64_t>());
}

/// Records of a scene know no blocks. The joints of the mechanism have been here all the time.
TEST_P(Blocks, APutBackToTheSceneBindsMechanismsAgain) {
  core::ClusterState start;
  start.bodies = chain(scene);
  RegionWorld world(scene, settings);
  for (int time = 0; time < 2; ++time) {
    world.put_back(0, start);
    world.step();
    for (const BodyRecord& link : world.records()) EXPECT_EQ(link.block, (Block{2, 0}));
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Blocks, ::testing::Values(Solver::kSoftStep, Solver::kSequentialImpulse),
                         [](const auto& param) {
                           return std::string(param.param == Solver::kSoftStep ? "SoftStep" : "SequentialImpulse");
                         });

TEST(BlocksOfTheSoftStep, TheBlocksOfBodiesDecideBits) {
  core::Scene scene = scene_of_all_shapes();
  Settings settings = small_blocks();
  settings.block_m = 8;  // so that boxes are no giants
  std::vector<BodyRecord> one = stack(1, 6, 8.1, 1);
  for (BodyRecord& box : one) box.block = {0, 0};
  std::vector<BodyRecord> other = one;
  for (const std::size_t i : {0, 3, 4}) other[i].block = {1, 0};
  RegionWorld world(scene, settings), same(scene, settings), elsewhere(scene, settings);
  world.add(one), same.add(one), elsewhere.add(other);
  run(world, 60), run(same, 60), run(elsewhere, 60);
  EXPECT_EQ(different(same.records(), world.records()).size(), 0u);
  const auto moved_otherwise = [&](std::size_t i) { return world.records()[i].p_WB != elsewhere.records()[i].p_WB; };
  EXPECT_TRUE(moved_otherwise(3));
}

void expect_same_bits(const core::Scene& scene, std::vector<BodyRecord> bodies, double side_m,
                      std::mt19937_64& random) {
  std::vector<BodyRecord> alone;
  for (const int threads : {1, 2, 3}) {
    Settings settings = small_blocks();
    settings.block_m = side_m;
    settings.threads = threads;
    RegionWorld world(scene, settings);
    world.add(bodies);
    std::shuffle(bodies.begin(), bodies.end(), random);
    run(world, 100);
    if (threads == 1) alone.assign(world.records().begin(), world.records().end());
    EXPECT_EQ(different(world.records(), alone), std::vector<std::uint64_t>()) << threads << " threads";
  }
}

/// Piles on edges and corners of blocks. With the smaller blocks, most bodies are giants.
TEST(BlocksOfTheSoftStep, SameBitsWithAnyOrderOfArrivalAndNumberOfThreads) {
  core::Scene scene = scene_of_all_shapes();
  std::mt19937_64 random(5);
  std::vector<BodyRecord> bodies;
  for (int i = 0; i < 9; ++i) {
    const std::vector<BodyRecord> more =
        pile(random, 1 + 100 * static_cast<std::uint64_t>(i), 12, 3.0 * (i % 3), 3.0 * (i / 3));
    bodies.insert(bodies.end(), more.begin(), more.end());
  }
  for (const double side_m : {6.5, 4.0}) expect_same_bits(scene, bodies, side_m, random);
}

}  // namespace
}  // namespace aurasim::physics::testing
