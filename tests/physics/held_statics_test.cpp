// A world holds the statics near its bodies only, and has the bits of a world that holds all (physics/held_statics.h).
#include "physics/held_statics.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"
#include "physics/static_floors.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

constexpr int kColumns = 100, kRows = 12;
constexpr double kTile_m = 4;
constexpr std::size_t kTiles = kColumns * kRows;
/// Prototype of a body that touches nothing, and whose bounds hold the whole world.
constexpr int kHuge = kKinds;

/// Tiles from x = 0 to 400 m and y = -24 to 24 m, of which every seventh is a hull and every eleventh a mesh.
core::Scene tiled_scene() {
  core::Scene scene = scene_of_all_shapes();
  scene.statics.clear();
  scene.materials.push_back(scene.materials.front());
  const core::Shape kinds[] = {core::Box{{kTile_m / 2, kTile_m / 2, 0.25}},
                               hull_of_box({kTile_m / 2, kTile_m / 2, 0.25}), grid(1, kTile_m - 2, kTile_m / 2)};
  const auto first = static_cast<std::uint32_t>(scene.shapes.size());
  for (const core::Shape& kind : kinds) scene.shapes.push_back({"tile", kind});
  for (int i = 0; i < static_cast<int>(kTiles); ++i) {
    const std::uint32_t kind = i % 11 == 0 ? 2 : i % 7 == 0 ? 1 : 0;
    const Vec3 middle((i % kColumns + 0.5) * kTile_m, (i / kColumns + 0.5 - kRows / 2) * kTile_m,
                      kind == 2 ? 0 : -0.25);
    core::StaticBody tile;
    tile.shape = first + kind;
    tile.material = 1;
    tile.pose.p_WB = middle;
    scene.statics.push_back(tile);
  }
  scene.shapes.push_back({"huge", core::Sphere{2000}});
  core::Prototype huge = scene.prototypes.front();
  huge.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  huge.collides = false;
  scene.prototypes.push_back(huge);
  return scene;
}

core::BodyRecord huge_body() { return body(1'000'000, kHuge, {200, 0, 0}); }

/// Bodies of all kinds that fly and slide in all directions.
std::vector<core::BodyRecord> thrown(int count) {
  std::mt19937_64 random(43);
  std::vector<core::BodyRecord> bodies;
  for (int i = 0; i < count; ++i) {
    const Vec3 p(uniform(random, 20, 60), uniform(random, -20, 20), uniform(random, 1, 3));
    bodies.push_back(body(static_cast<std::uint64_t>(i), i % kKinds, p,
                          {uniform(random, 0, 30), uniform(random, -8, 8), uniform(random, -4, 4)}));
  }
  return bodies;
}

Settings with(Solver solver) {
  Settings settings = balanced();
  settings.solver = solver;
  return settings;
}

class HeldStaticsOf : public ::testing::TestWithParam<Solver> {};
INSTANTIATE_TEST_SUITE_P(Solvers, HeldStaticsOf, ::testing::Values(Solver::kSoftStep, Solver::kSequentialImpulse));

TEST_P(HeldStaticsOf, AWorldHasTheBitsOfOneThatHoldsAll) {
  const core::Scene scene = tiled_scene();
  RegionWorld some(scene, with(GetParam())), all(scene, with(GetParam()));
  const std::vector<core::BodyRecord> bodies = thrown(60);
  some.add(bodies);
  all.add(bodies);
  all.add(std::vector{huge_body()});
  for (int step = 0; step < 300; ++step) {
    some.step();
    all.step();
    ASSERT_EQ(different(some.records(), all.records()), std::vector<std::uint64_t>{}) << step;
  }
  EXPECT_EQ(all.held_statics(), kTiles);
  EXPECT_LT(some.held_statics(), kTiles);
}

TEST_P(HeldStaticsOf, ABodyMeetsEachTileOnItsWay) {
  const core::Scene scene = tiled_scene();
  RegionWorld world(scene, with(GetParam()));
  world.add(std::vector{body(1, kSphere, {2, 2, 0.5}, {60, 0, 0})});
  std::size_t most = 0;
  while (world.records().empty() || world.records()[0].p_WB.x() < 390) {
    world.step();
    ASSERT_LT(world.step_number(), 2000);
    ASSERT_GT(world.records()[0].p_WB.z(), 0.35) << world.records()[0].p_WB.x();
    most = std::max(most, world.held_statics());
  }
  EXPECT_LT(most, kTiles / 4);
}

TEST(HeldStatics, GoWhenNothingIsNear) {
  const core::Scene scene = tiled_scene();
  RegionWorld world(scene, balanced());
  EXPECT_EQ(world.held_statics(), 0U);
  world.add(std::vector{body(1, kSphere, {50, 0, 0.5})});
  world.step();
  EXPECT_GT(world.held_statics(), 0U);
  world.release(std::vector{core::BodyId{1}});
  run(world, 300);
  EXPECT_EQ(world.held_statics(), 0U);
}

/// The body sleeps on tiles that the new world has not held before.
TEST(HeldStatics, AHandOffBringsThem) {
  const core::Scene scene = tiled_scene();
  RegionWorld stays(scene, balanced()), from(scene, balanced()), to(scene, balanced());
  const std::vector<core::BodyRecord> pile = {body(1, kBox, {48, 0, 0.6}),
                                              body(2, kHull, {48.2, 0.1, 1.8}, {0, 0, -1})};
  for (RegionWorld* world : {&stays, &from}) {
    world->add(pile);
    run(*world, 40);
  }
  run(to, 40);
  to.adopt(from.release(ids_of(pile)), to.step_number());
  for (int step = 0; step < 100; ++step) {
    stays.step();
    to.step();
    ASSERT_EQ(different(to.records(), stays.records()), std::vector<std::uint64_t>{}) << step;
  }
}

TEST(HeldStatics, AWorldGoesBackToWhereItHasLetThemGo) {
  const core::Scene scene = tiled_scene();
  RegionWorld world(scene, balanced());
  world.add(std::vector{body(1, kBox, {8, 2, 0.45}, {40, 0, 0})});
  run(world, 20);
  const core::ClusterState then = world.peek_all();
  run(world, 50);
  const std::vector<core::BodyRecord> first(world.records().begin(), world.records().end());
  run(world, 400);
  world.put_back(20, then);
  run(world, 50);
  EXPECT_EQ(different(world.records(), first), std::vector<std::uint64_t>{});
}

TEST(HeldStatics, ARayMeetsOnesThatAreFarFromAllBodies) {
  const core::Scene scene = tiled_scene();
  const RegionWorld world(scene, balanced());
  const RayHit down = world.cast({202, 2, 10}, {202, 2, -10});
  ASSERT_TRUE(down.object);
  EXPECT_NEAR(down.distance_m, 10, 0.05);
  const RayHit along = world.cast({-50, 2, -0.1}, {390, 2, -0.1});
  ASSERT_TRUE(along.object);
  EXPECT_NEAR(along.p_W.x(), 0, 0.1);
}

TEST(HeldStatics, OneThatAClientHasRemovedStaysAway) {
  const core::Scene scene = tiled_scene();
  RegionWorld world(scene, balanced());
  const auto index = static_cast<std::uint32_t>(kRows / 2 * kColumns + 50);  // from x = 200 to 204 m, y = 0 to 4 m
  core::Order order;
  order.at_step = 5;
  order.action = core::RemoveStatic{core::StaticId{index}};
  world.schedule(order);
  run(world, 10);
  world.add(std::vector{body(1, kSphere, {202, 2, 2}), body(2, kSphere, {210, 2, 2})});
  run(world, 120);
  EXPECT_LT(world.records()[0].p_WB.z(), -3);
  EXPECT_GT(world.records()[1].p_WB.z(), 0.3);
}

TEST(StaticPlaces, FindTheStaticsOfABox) {
  const core::Scene scene = tiled_scene();
  const ShapeSet shapes(scene);
  const StaticPlaces places(scene, shapes);
  EXPECT_EQ(places.size(), kTiles);
  std::mt19937_64 random(7);
  for (int i = 0; i < 200; ++i) {
    const btVector3 low(btScalar(uniform(random, -50, 450)), btScalar(uniform(random, -50, 50)), -1);
    const Bounds where{low, low + btVector3(btScalar(uniform(random, 0, 60)), btScalar(uniform(random, 0, 60)), 2)};
    std::set<std::uint32_t> found;
    places.for_each_cell(where, [&](std::uint32_t cell) {
      for (const std::uint32_t index : places.in(cell)) found.insert(index);
    });
    for (std::uint32_t k = 0; k < kTiles; ++k) {
      const Bounds tile = bounds_of_static(scene, k, shapes);
      const bool meets = tile.low.x() <= where.high.x() && tile.high.x() >= where.low.x() &&
                         tile.low.y() <= where.high.y() && tile.high.y() >= where.low.y();
      EXPECT_TRUE(!meets || found.contains(k)) << i << " " << k;
    }
    EXPECT_LE(found.size(), 10'000 / (kTile_m * kTile_m));
  }
}

/// A body that breaks down may have such bounds.
TEST(StaticPlaces, HaveNoCellsWithoutNumbers) {
  const core::Scene scene = tiled_scene();
  const StaticPlaces places(scene, ShapeSet(scene));
  std::size_t cells = 0;
  const btScalar none = std::numeric_limits<btScalar>::quiet_NaN(), far = BT_LARGE_FLOAT;
  const auto count = [&](std::uint32_t) { ++cells; };
  places.for_each_cell({{none, none, none}, {none, none, none}}, count);
  EXPECT_EQ(cells, 0U);
  places.for_each_cell({{-far, -far, -far}, {far, far, far}}, count);
  EXPECT_EQ(cells, places.cell_count());
}

}  // namespace
}  // namespace aurasim::physics::testing
