// The soft step: what it is exact in, what stands, and that its lanes change no bit.
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"
#include "physics/soft/lanes.h"

namespace aurasim::physics::testing {
namespace {

Settings soft_settings(int substeps = 8) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.substeps = substeps;
  return settings;
}

/// A pyramid in the plane y = 0, of unit boxes.
std::vector<core::BodyRecord> pyramid(int rows) {
  std::vector<core::BodyRecord> boxes;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < rows - row; ++k) {
      boxes.push_back(body(boxes.size(), 0, {k - 0.5 * (rows - row - 1), 0, row + 0.5}));
    }
  }
  return boxes;
}

struct Change {
  double most_m = 0;
  double fastest_m_s = 0;
};

Change change(RegionWorld& world, const std::vector<core::BodyRecord>& start) {
  Change change;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const core::BodyRecord& now = world.records()[i];
    change.most_m = std::max(change.most_m, (now.p_WB - start[i].p_WB).norm());
    change.fastest_m_s = std::max(change.fastest_m_s, now.v_WB.norm());
  }
  return change;
}

TEST(SoftStep, APyramidStands) {
  core::Scene scene = scene_of(core::Box{});
  scene.prototypes[0].can_sleep = false;
  RegionWorld world(scene, soft_settings());
  const std::vector<core::BodyRecord> boxes = pyramid(20);
  world.add(boxes);
  run(world, 300);
  const Change after = change(world, boxes);
  EXPECT_LT(after.most_m, 0.01);
  EXPECT_LT(after.fastest_m_s, 0.02);
}

TEST(SoftStep, WhatTouchesNothingFallsOnAParabola) {
  core::Scene scene = scene_of(core::Box{});
  scene.materials[0] = {};
  RegionWorld world(scene, soft_settings());
  const core::Vec3 p(1, 2, 100), v(3, -4, 5);
  world.add(std::vector{body(1, 0, p, v)});
  run(world, 120);
  const core::Vec3 expected = p + 2 * v + 0.5 * 2 * 2 * scene.gravity;
  const double exact = RegionWorld::precision() == std::string("double") ? 1e-9 : 1e-3;
  EXPECT_LT((world.records()[0].p_WB - expected).norm(), exact);
  EXPECT_LT((world.records()[0].v_WB - (v + 2 * scene.gravity)).norm(), exact);
}

/// Within what it falls in the step in which it touches.
TEST(SoftStep, ABoxBouncesToTheSquareOfItsRestitution) {
  core::Scene scene = scene_of(core::Box{});
  scene.materials[0] = {};
  scene.materials[0].restitution = std::sqrt(0.6);  // Bullet multiplies the two
  RegionWorld world(scene, soft_settings());
  world.add(std::vector{body(1, 0, {0, 0, 4.5})});
  double top = 0;
  bool has_bounced = false;
  for (int i = 0; i < 120; ++i) {
    world.step();
    has_bounced = has_bounced || world.records()[0].v_WB.z() > 0;
    if (has_bounced) top = std::max(top, world.records()[0].p_WB.z() - 0.5);
  }
  EXPECT_NEAR(top, 0.6 * 0.6 * 4, 0.15);
}

/// Two boxes on a slope of 20 degrees that friction holds, for a minute.
TEST(SoftStep, WhatFrictionHoldsDoesNotCreep) {
  core::Scene scene = scene_of(core::Box{});
  scene.prototypes[0].can_sleep = false;
  scene.materials[0].friction = 1;
  scene.gravity = 9.81 * core::Vec3(std::sin(0.35), 0, -std::cos(0.35));
  RegionWorld world(scene, soft_settings(4));
  world.add(std::vector{body(1, 0, {0, 0, 0.5}), body(2, 0, {0, 0, 1.5})});
  run(world, 60);
  const core::Vec3 low = world.records()[0].p_WB, high = world.records()[1].p_WB;
  run(world, 3600);
  EXPECT_LT((world.records()[0].p_WB - low).norm(), 1e-3);
  EXPECT_LT((world.records()[1].p_WB - high).norm(), 1e-3);
}

/// It has been pushed out of a wall, by which contacts stay that a look at the shapes would not find any more. Its
/// bounds have to say that it is near.
TEST(SoftStep, ASleeperThatIsHandedOverKeepsContactsThatHaveOpened) {
  core::Scene scene = scene_of(core::Box{});
  scene.shapes.push_back({"wall", core::Box{core::Vec3(0.5, 2, 1)}});
  core::StaticBody wall;
  wall.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  wall.pose.p_WB = {-0.95, 0, 1};
  scene.statics.push_back(wall);
  RegionWorld one(scene, soft_settings(4)), other(scene, soft_settings(4)), next(scene, soft_settings(4));
  const std::vector<core::BodyRecord> box = {body(1, 0, {0, 0, 0.5})};
  for (RegionWorld* world : {&one, &other}) world->add(box);
  for (RegionWorld* world : {&one, &other, &next}) run(*world, 400);
  ASSERT_FALSE(one.snapshot().bodies[0].awake);
  next.adopt(other.release(ids_of(box)), next.step_number());
  for (RegionWorld* world : {&one, &next}) {
    world->add(std::vector{body(2, 0, {0.3, 0, 2.2}, {0, 0, -5})});
    run(*world, 100);
  }
  EXPECT_TRUE(different(next.records(), one.records()).empty());
}

/// More contacts than there are colours: the rest are solved one by one.
TEST(SoftStep, ASlabBearsMoreBoxesThanThereAreColours) {
  core::Scene scene = scene_of_all_shapes();
  scene.shapes.push_back({"slab", core::Box{core::Vec3(8, 8, 0.5)}});
  scene.prototypes.push_back({"slab", static_cast<std::uint32_t>(scene.shapes.size() - 1), 0, 500});
  const int slab = static_cast<int>(scene.prototypes.size()) - 1;
  RegionWorld world(scene, soft_settings());
  std::vector<core::BodyRecord> bodies = {body(0, slab, {0, 0, 0.5})};
  for (int i = 0; i < 100; ++i)
    bodies.push_back(body(bodies.size(), kSphere, {1.4 * (i % 10) - 6.3, 1.4 * (i / 10) - 6.3, 1.5}));
  world.add(bodies);
  run(world, 120);
  EXPECT_LT(change(world, bodies).most_m, 0.05 + 0.6);  // spheres are smaller than 0.5 m, and fall onto it
  for (const core::BodyRecord& now : world.records()) EXPECT_GT(now.p_WB.z(), 0.45);
  EXPECT_LT(change(world, bodies).fastest_m_s, 0.05);
}

TEST(SoftStep, APendulumKeepsItsLength) {
  core::Scene scene = scene_of(core::Sphere{0.25});
  scene.statics.clear();
  place_body(scene, 0, {2, 0, 5});
  add_joint(scene, core::BallJoint{}, 0, std::nullopt, {0, 0, 5});
  RegionWorld world(scene, soft_settings());
  world.add(initial_records(scene));
  for (int i = 0; i < 240; ++i) {
    world.step();
    ASSERT_NEAR((world.records()[0].p_WB - core::Vec3(0, 0, 5)).norm(), 2, 0.02) << "step " << i;
  }
}

/// Blocks of random numbers, among them lanes without a patch.
std::vector<soft::Block> random_blocks(std::mt19937_64& random, std::size_t count, std::uint32_t movers) {
  std::vector<soft::Block> blocks(count);
  for (soft::Block& block : blocks) {
    std::memset(static_cast<void*>(&block), 0, sizeof block);
    for (int lane = 0; lane < soft::kLanes; ++lane) {
      block.a[lane] = static_cast<std::uint32_t>(random() % movers);
      block.b[lane] = static_cast<std::uint32_t>(random() % movers);
    }
    auto* const first = &block.inv_mass_a;
    const auto lanes = static_cast<std::size_t>(reinterpret_cast<soft::Lanes*>(&block + 1) - first);
    for (std::size_t i = 0; i < lanes; ++i) {
      for (int lane = 0; lane < soft::kLanes; ++lane) {
        first[i][lane] = random() % 8 == 0 ? 0 : static_cast<soft::Real>(uniform(random, -1, 2));
      }
    }
  }
  return blocks;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()), a.size() * sizeof(T)) == 0;
}

TEST(SoftStep, EverySetOfInstructionsHasTheSameBits) {
  std::mt19937_64 random(7);
  constexpr std::uint32_t kMovers = 60;
  std::vector<soft::Kernel> kernels = {soft::kernel_sse2()};
  if (__builtin_cpu_supports("avx2")) kernels.push_back(soft::kernel_avx2());
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(soft::kernel_avx512());
  }
  const std::vector<soft::Block> blocks = random_blocks(random, 50, kMovers);
  std::vector<soft::Mover> movers(kMovers);
  for (std::size_t i = 1; i < movers.size(); ++i) {
    for (auto* triple : {&movers[i].v, &movers[i].w, &movers[i].dp}) {
      for (soft::Real& x : *triple) x = static_cast<soft::Real>(uniform(random, -1, 1));
    }
  }
  std::vector<std::vector<soft::Block>> blocks_of;
  std::vector<std::vector<soft::Mover>> movers_of;
  for (const soft::Kernel& kernel : kernels) {
    std::vector<soft::Block>& b = blocks_of.emplace_back(blocks);
    std::vector<soft::Mover>& m = movers_of.emplace_back(movers);
    kernel.warm_start(b.data(), b.size(), 4, m.data());
    for (const bool pushes : {true, false}) kernel.solve(b.data(), b.size(), 3, m.data(), {240, 3, pushes});
    kernel.bounce(b.data(), b.size(), 2, m.data(), soft::Real(-0.5));
  }
  EXPECT_FALSE(same_bytes(movers_of[0], movers));
  for (std::size_t i = 1; i < kernels.size(); ++i) {
    EXPECT_TRUE(same_bytes(blocks_of[i], blocks_of[0])) << i;
    EXPECT_TRUE(same_bytes(movers_of[i], movers_of[0])) << i;
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
