// Sleep of the soft step: nothing sleeps in the air after its support has gone.
#include <cstdint>
#include <random>
#include <vector>

#include "physics/sleep_scenes.h"

namespace aurasim::physics::testing {
namespace {

TEST_F(Plank, WhoseSupportIsTakenAwayLeavesNobodyInTheAir) {
  for (std::uint64_t i = 2; i < 5; ++i) order(core::RemoveBody{BodyId{i}});
  world->step();
  for (std::uint64_t i = 10; i < 15; ++i) EXPECT_FALSE(sleeps(i)) << "it lies on the plank";
  fall_asleep(1000);
  EXPECT_LT(record_of(24).p_WB.z(), 2);
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

TEST_F(Sleep, WhoLiesOnAStaticThatIsRemovedFalls) {
  core::StaticBody slab;  // below stacks in five blocks, which bear a plank
  slab.shape = static_cast<std::uint32_t>(scene.shapes.size());
  scene.shapes.push_back({"slab", core::Box{{9, 2, 0.5}}});
  slab.pose.p_WB = {10, 2, 0.5};
  scene.statics.push_back(slab);
  make_world(kSide);
  for (std::uint64_t i = 0; i < 5; ++i) {
    const double x = 2 + 4 * static_cast<double>(i);
    place(i, kCube, {x, 2, 1.5});
    place(10 + i, kCube, {x, 2, 2.5});
  }
  place(100, kPlank, {10, 2, 3.1});
  fall_asleep(300);
  order(core::RemoveStatic{core::StaticId{1}});
  world->step();
  EXPECT_EQ(sleepers(), 0u);
  fall_asleep(600);
  EXPECT_LT(record_of(100).p_WB.z(), 2.2);
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

}  // namespace
}  // namespace aurasim::physics::testing
