// Sleep of the soft step, over many blocks: who falls asleep and who wakes, in which state.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "physics/sleep_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Step;

constexpr int kBlocks = 30, kCubes = 4 * kBlocks - 1;  // in a row

/// Lets a heavy ball fly into the row.
void hit(RegionWorld& world) {
  const BodyRecord hammer = body(1000, kHammer, {0.6, 2, 0.5}, {10, 0, 0});
  world.add({&hammer, 1});
}

TEST_F(Sleep, WakingGoesOnByABlockInAState) {
  place_row(kCubes);
  fall_asleep(200);
  hit(*world);
  const std::vector<int> woken = wake_times(kCubes, 60);
  std::array<int, kBlocks> first{};
  for (std::size_t i = 0; i < kCubes; ++i) {
    const std::size_t block = (i + 1) / 4;
    ASSERT_GT(woken[i], 0) << "cube " << i << " has not woken";
    if (first[block] == 0) first[block] = woken[i];
    EXPECT_EQ(first[block], woken[i]) << "a part wakes as a whole";
  }
  EXPECT_EQ(first[1], first[0]) << "the neighbour of what is hit wakes with it";
  for (std::size_t block = 2; block < kBlocks; ++block) EXPECT_EQ(first[block], first[block - 1] + 1) << block;
}

TEST_F(Sleep, InOneBlockAllWakeAtOnce) {
  make_world(kOneBlock);
  place_row(kCubes);
  fall_asleep(200);
  hit(*world);
  const std::vector<int> woken = wake_times(kCubes, 60);
  EXPECT_GT(woken.front(), 0);
  EXPECT_EQ(std::ranges::count(woken, woken.front()), kCubes);
}

TEST_F(Sleep, WakingGoesNoFartherThanMotion) {
  place_row(kCubes);
  fall_asleep(200);
  place(1000, kBall, {1.5, 2, 1.55});
  const std::vector<int> woken = wake_times(kCubes, 400);
  EXPECT_EQ(std::ranges::count_if(woken, [](int n) { return n > 0; }), 7) << "the block of the ball and the next one";
  EXPECT_EQ(sleepers(), kCubes + 1u) << "all sleep again";
}

TEST_F(Sleep, ARowFallsAsleepAtOnce) {
  place_row(kCubes);
  EXPECT_LE(fall_asleep(200), 122) << "2 s, and two states";
}

TEST_F(Sleep, WhoNeverSleepsKeepsAwakeNoMoreThanTheNextBlock) {
  place_row(kCubes);
  place(1000, kWatchman, {0.5, 2, 0.5});
  fall_asleep(200, 1 + 7);
  for (std::uint64_t id = 0; id < kCubes; ++id) EXPECT_EQ(sleeps(id), id >= 7) << id;
  for (int n = 0; n < 300; ++n) {
    world->step();
    ASSERT_EQ(sleepers(), kCubes - 7u) << "nobody wakes and sleeps by turns";
  }
}

TEST_F(Sleep, WhatIsPushedSlowlyDoesNotFallAsleep) {
  for (core::Material& material : scene.materials) material.friction = 0.2;
  make_world(kSide);
  place_row(24);
  place(1000, kHammer, {0.7, 2, 0.5}, {0.3, 0, 0});
  const double start = record_of(23).p_WB.x();
  for (int n = 0; n < 300; ++n) {  // slower than what Bullet holds for asleep
    order(core::SetVelocity{BodyId{1000}, {0.3, 0, 0}, {}});
    world->step();
  }
  EXPECT_NEAR(record_of(23).p_WB.x() - start, 0.3 * 5, 0.1);
}

TEST_F(Sleep, NoMomentumIsLostOnASeam) {
  scene.gravity.setZero();
  scene.materials[0].friction = 0;
  for (const double restitution : {0.0, 1.0}) {
    scene.materials[0].restitution = restitution;
    for (const double x : {2.5, 3.5}) {  // the seam is in the middle of the row, or before the last ball
      make_world(kSide);
      for (int i = 0; i < 4; ++i) place(static_cast<std::uint64_t>(i), kBall, {x + i - 1, 2, 10});
      fall_asleep(130);
      place(1000, kBall, {x - 3, 2, 10}, {6, 0, 0});
      run(*world, 60);
      double sum = 0;
      for (const BodyRecord& record : world->records()) sum += record.v_WB.x();
      EXPECT_NEAR(sum, 6, 1e-4);
      EXPECT_GT(record_of(3).v_WB.x(), 1);
    }
  }
}

TEST_F(Plank, OverManyBlocksWakesAllThatTouchIt) {
  order(core::Impulse{BodyId{kPlank_}, {0, 30, 0}});
  world->step();
  EXPECT_EQ(sleepers(), 0u);
  fall_asleep(400);
}

TEST_F(Plank, ThatIsOnlyTouchedWakesNobodyElse) {
  place(1000, kBall, {2.3, 2, 3.7});
  int most = 0;
  for (int n = 0; n < 400; ++n) {
    world->step();
    most = std::max(most, static_cast<int>(world->records().size() - sleepers()));
  }
  EXPECT_EQ(most, 3 + 4) << "the ball and the stack below it; the plank and what touches it in its own block";
  EXPECT_EQ(sleepers(), world->records().size());
}

/// Balls on joints: one mechanism, in one block, over 25 blocks.
TEST_F(Sleep, AChainOverManyBlocksSleepsAndWakesAsAWhole) {
  constexpr std::uint64_t kLinks = 100;
  for (std::uint64_t i = 0; i < kLinks; ++i) {
    const double x = static_cast<double>(i);
    core::InitialBody& link = place_body(scene, kBall, {0.5 + x, 2, 0.5});
    link.id = BodyId{i};
    if (i > 0) add_joint(scene, core::BallJoint{}, i, i - 1, {x, 2, 0.5});
  }
  make_world(kSide);
  world->add(initial_records(scene));
  for (std::uint64_t i = 0; i < 24; ++i) place(200 + i, kCube, {2 + 4 * static_cast<double>(i), 3, 0.5});
  place(300, kCube, {98, 4, 0.5});  // in the block beyond a cube that touches the chain
  place(301, kCube, {98, 5, 0.5});
  fall_asleep(600);
  order(core::Impulse{BodyId{0}, {0, 0, 0.5}});
  world->step();
  for (std::uint64_t i = 0; i < kLinks; ++i) EXPECT_FALSE(sleeps(i)) << i;
  for (std::uint64_t i = 0; i < 24; ++i) EXPECT_FALSE(sleeps(200 + i)) << i;
  EXPECT_TRUE(sleeps(301)) << "nothing moves beside it";
  fall_asleep(600);
}

/// Four stacks that lean on each other, around a corner of four blocks, with a cube on top of all.
class CornerStack : public Sleep {
 protected:
  CornerStack() {
    for (std::uint64_t i = 0; i < 12; ++i) {
      const double x = i % 2 == 0 ? 3.5 : 4.5, y = i / 2 % 2 == 0 ? 3.5 : 4.5;
      place(i, kCube, {x, y, 0.5 + static_cast<double>(i / 4)});
    }
    place(12, kCube, {4, 4, 3.5});
    fall_asleep(300);
  }
};

TEST_F(CornerStack, StaysAsleep) {
  const std::uint64_t hash = hash_sum(world->records());
  run(*world, 300);
  EXPECT_EQ(hash_sum(world->records()), hash);
}

TEST_F(CornerStack, IsWokenByABallAndSleepsAgain) {
  place(100, kBall, {4, 4, 4.8});
  int woken = 0;
  for (int n = 0; n < 60; ++n) {
    world->step();
    woken += sleeps(0) || sleeps(3) ? 0 : 1;
  }
  EXPECT_GT(woken, 20);
  fall_asleep(900);
  for (std::uint64_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(record_of(i).p_WB.z(), 0.5 + static_cast<double>(i / 4), 0.02) << i;
  }
  expect_rests_on_something();
}

/// All hashes of a run in which a row wakes and falls asleep.
std::vector<std::uint64_t> hashes_of_a_row(RegionWorld& world, int steps) {
  std::vector<std::uint64_t> hashes;
  for (int n = 0; n < steps; ++n) {
    if (n == 150) hit(world);
    world.step();
    hashes.push_back(hash_sum(world.records()));
  }
  return hashes;
}

TEST_F(Sleep, HasTheSameBitsOnAnyNumberOfThreads) {
  std::vector<std::uint64_t> alone;
  for (const int threads : {1, 2, 3}) {
    make_world(kSide, threads);
    place_row(kCubes);
    const std::vector<std::uint64_t> hashes = hashes_of_a_row(*world, 400);
    if (threads == 1) alone = hashes;
    EXPECT_EQ(hashes, alone) << threads;
  }
}

/// In every state all goes through another world, which knows nothing but the state.
TEST_F(Sleep, FollowsFromTheStateAlone) {
  place_row(kCubes);
  const std::vector<std::uint64_t> stays = hashes_of_a_row(*world, 300);
  make_world(kSide);
  place_row(kCubes);
  for (int n = 0; n < 300; ++n) {
    if (n == 150) hit(*world);
    world->step();
    ASSERT_EQ(hash_sum(world->records()), stays[static_cast<std::size_t>(n)]) << n;
    const core::ClusterState all = world->peek_all();
    const Step now = world->step_number();
    make_world(kSide);
    run(*world, static_cast<int>(now));
    world->adopt(all, now);
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
