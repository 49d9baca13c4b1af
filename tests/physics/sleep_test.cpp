// Sleep of the soft step, over many blocks: who falls asleep and who wakes, in which state.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::Step;
using core::Vec3;

constexpr double kSide = 4, kOneBlock = 1e5;
constexpr int kAsleep = 2;

/// Kinds of bodies. The hammer is a small ball of 1000 kg, the plank has 20 kg, the others have 1.
enum Thing { kCube, kBall, kHammer, kPlank, kWatchman };

core::Scene scene_of_things() {
  core::Scene scene = scene_of(core::Box{{0.5, 0.5, 0.5}});
  scene.materials[0].rolling_friction = scene.materials[0].spinning_friction = 0;
  scene.materials[0].linear_damping = scene.materials[0].angular_damping = 0;
  const auto add = [&scene](const core::Shape& shape, double mass_kg) {
    scene.shapes.push_back({"thing " + std::to_string(scene.shapes.size()), shape});
    core::Prototype& kind = scene.prototypes.emplace_back();
    kind.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
    kind.mass_kg = mass_kg;
  };
  add(core::Sphere{0.5}, 1);
  add(core::Sphere{0.3}, 1000);
  add(core::Box{{10, 0.5, 0.1}}, 20);
  add(core::Box{{0.5, 0.5, 0.5}}, 1);
  scene.prototypes[kWatchman].can_sleep = false;
  return scene;
}

class Sleep : public ::testing::Test {
 protected:
  Sleep() { make_world(kSide); }

  /// An empty world, which follows the scene.
  void make_world(double side_m, int threads = 1) {
    Settings settings;
    settings.solver = Solver::kSoftStep;
    settings.continuous = true;
    settings.block_m = side_m;
    settings.threads = threads;
    world.emplace(scene, settings);
  }
  void place(std::uint64_t id, int kind, const Vec3& p_WB, const Vec3& v_WB = Vec3::Zero()) {
    const BodyRecord record = body(id, kind, p_WB, v_WB);
    world->add({&record, 1});
  }
  /// Cubes with the ids 0, 1, 2 ... that touch, along x: three in block 0, then four in each block.
  void place_row(int cubes) {
    for (int i = 0; i < cubes; ++i) place(static_cast<std::uint64_t>(i), kCube, {1.5 + i, 2, 0.5});
  }
  void order(const core::Action& action) {
    core::Order order;
    order.request = ++orders_;
    order.at_step = world->step_number() + 1;
    order.action = action;
    world->schedule(order);
  }
  bool sleeps(std::uint64_t id) { return record_of(id).activation_state == kAsleep; }
  const BodyRecord& record_of(std::uint64_t id) {
    return *std::ranges::find(world->records(), BodyId{id}, &BodyRecord::id);
  }
  std::size_t sleepers() {
    return static_cast<std::size_t>(std::ranges::count(world->records(), kAsleep, &BodyRecord::activation_state));
  }
  /// Steps until all bodies sleep but so many; the number of steps.
  int fall_asleep(int most_steps, std::size_t but = 0) {
    for (int n = 1; n <= most_steps; ++n) {
      world->step();
      if (sleepers() + but == world->records().size()) return n;
    }
    ADD_FAILURE() << sleepers() << " of " << world->records().size() << " sleep after " << most_steps << " steps";
    return most_steps;
  }
  /// For each of the bodies with the ids 0, 1, 2 ...: number of the step in which it wakes; 0: it sleeps on.
  std::vector<int> wake_times(int bodies, int steps) {
    std::vector<int> woken(static_cast<std::size_t>(bodies), 0);
    for (int n = 1; n <= steps; ++n) {
      world->step();
      for (std::size_t id = 0; id < woken.size(); ++id) {
        if (woken[id] == 0 && !sleeps(id)) woken[id] = n;
      }
    }
    return woken;
  }
  /// If all wake, nothing falls.
  void expect_rests_on_something() {
    std::vector<BodyRecord> awake(world->records().begin(), world->records().end());
    for (BodyRecord& record : awake) record.activation_state = 1, record.deactivation_time = 0;
    make_world(kOneBlock);
    world->add(awake);
    run(*world, 60);
    for (const BodyRecord& before : awake) {
      EXPECT_GT(record_of(core::value_of(before.id)).p_WB.z(), before.p_WB.z() - 0.05) << core::value_of(before.id);
    }
  }

  core::Scene scene = scene_of_things();
  std::optional<RegionWorld> world;

 private:
  std::uint64_t orders_ = 0;
};

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

/// A plank that lies on pillars in five blocks, with cubes on it.
class Plank : public Sleep {
 protected:
  static constexpr std::uint64_t kPlank_ = 100;

  Plank() {
    for (std::uint64_t i = 0; i < 5; ++i) {
      const double x = 2 + 4 * static_cast<double>(i);
      place(i, kCube, {x, 2, 0.5});
      place(10 + i, kCube, {x + 0.3, 2, 1.7});
      place(20 + i, kCube, {x + 0.3, 2, 2.7});
    }
    place(kPlank_, kPlank, {10, 2, 1.1});
    fall_asleep(300);
  }
};

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

TEST_F(Plank, WhoseSupportIsTakenAwayLeavesNobodyInTheAir) {
  for (std::uint64_t i = 2; i < 5; ++i) order(core::RemoveBody{BodyId{i}});
  world->step();
  for (std::uint64_t i = 10; i < 15; ++i) EXPECT_FALSE(sleeps(i)) << "it lies on the plank";
  fall_asleep(1000);
  EXPECT_LT(record_of(24).p_WB.z(), 2);
  expect_rests_on_something();
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
  for (std::uint64_t i = 0; i < 24; ++i) place(200 + i, kCube, {2 + 4 * static_cast<double>(i), 2.99, 0.5});
  place(300, kCube, {98, 3.99, 0.5});  // in the block beyond a cube that touches the chain
  place(301, kCube, {98, 4.99, 0.5});
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

/// A cube is knocked out from under another one so fast that the two no longer touch in the next state. What hits it is
/// two blocks away from that other one.
TEST_F(Sleep, ASupportThatIsGoneInOneStateLeavesNobodyInTheAir) {
  for (core::Material& material : scene.materials) material.friction = 0.1;
  make_world(kSide);
  place(0, kCube, {3.51, 3.9, 0.5});
  place(1, kCube, {4.51, 3.9, 0.5});
  place(2, kCube, {4.6, 4.2, 1.5});
  fall_asleep(200);
  ASSERT_EQ(record_of(0).block, (core::Block{0, 0}));
  ASSERT_EQ(record_of(1).block, (core::Block{1, 0}));
  ASSERT_EQ(record_of(2).block, (core::Block{1, 1}));
  place(1000, kHammer, {2.45, 3.9, 0.5}, {200, 0, 0});
  bool slept_beside = false;
  for (int n = 0; n < 10; ++n) {
    world->step();
    slept_beside = slept_beside || (!sleeps(1) && sleeps(2));
  }
  EXPECT_TRUE(slept_beside) << "the case is not met";
  run(*world, 60);
  EXPECT_NEAR(record_of(2).p_WB.z(), 0.5, 0.05);
}

/// The same for a support that goes away so slowly that it counts as still.
TEST_F(Sleep, ASupportThatCreepsAwayLeavesNobodyInTheAir) {
  for (core::Material& material : scene.materials) material.friction = 0;
  make_world(kSide);
  std::vector<BodyRecord> cubes = {body(0, kCube, {3.6, 2, 0.5}, {-0.04, 0, 0}), body(1, kCube, {4.55, 2, 1.5})};
  cubes[0].activation_state = 3;
  cubes[1].activation_state = kAsleep;
  cubes[1].deactivation_time = 3;
  world->add(cubes);
  run(*world, 60);
  EXPECT_TRUE(sleeps(1));
  run(*world, 60);
  EXPECT_NEAR(record_of(1).p_WB.z(), 0.5, 0.05);
}

/// Bodies are removed from piles at random, also from piles that sleep.
TEST_F(Sleep, NothingThatLosesItsSupportSleepsInTheAir) {
  scene = scene_of_all_shapes();
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    make_world(2);
    std::mt19937_64 random(seed);
    std::vector<BodyId> left;
    for (std::uint64_t i = 0; i < 9; ++i) {
      const double x = 1.3 * static_cast<double>(i % 3), y = 1.3 * static_cast<double>(i / 3);
      const std::vector<BodyRecord> bodies = pile(random, 100 * i, 10, x, y);
      world->add(bodies);
      for (const BodyRecord& record : bodies) left.push_back(record.id);
    }
    run(*world, 300);
    for (int i = 0; i < 30; ++i) {
      const std::size_t gone = random() % left.size();
      order(core::RemoveBody{left[gone]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(gone));
      run(*world, static_cast<int>(random() % 60));
    }
    fall_asleep(3000);
    expect_rests_on_something();
  }
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
