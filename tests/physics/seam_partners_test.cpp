// Coupled regions far apart exchange nothing, unless a body makes it necessary (core/seam_partners.h).
#include <gtest/gtest.h>

#include "physics/coupled_worlds.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::RegionMap;
using core::Vec3;

constexpr double kWidth_m = 8;  // of a column, and of a block

/// Small balls, and a long and flat box.
core::Scene small_and(const core::Vec3& size_m) {
  core::Scene scene = scene_of(core::Sphere{0.25});
  core::Prototype kind = scene.prototypes.front();
  kind.shape = static_cast<std::uint32_t>(scene.shapes.size());
  kind.mass_kg = 30;
  scene.shapes.push_back({"long", core::Box{size_m / 2}});
  scene.prototypes.push_back(kind);
  for (core::Prototype& one : scene.prototypes) one.can_sleep = false;
  return scene;
}

double border_x(int border, int columns) { return kWidth_m * (border + 1 - columns / 2.0); }

/// Two layers of balls over each border between columns.
std::vector<BodyRecord> balls_over_borders(int columns) {
  std::vector<BodyRecord> bodies;
  for (int border = 0; border + 1 < columns; ++border) {
    for (int i = 0; i < 8; ++i) {
      const Vec3 p(border_x(border, columns) + 0.52 * (i % 4 - 1.5), 0.1 * (i % 2), 0.25 + 0.5 * (i / 4));
      bodies.push_back(body(bodies.size() + 1, 0, p));
    }
  }
  return bodies;
}

/// Number of parcels in 60 states.
std::size_t parcels_of(int columns) {
  const core::Scene scene = small_and({1, 1, 1});
  CoupledWorlds many(scene, soft_step_with_blocks(kWidth_m),
                     RegionMap::columns(static_cast<std::size_t>(columns), kWidth_m), balls_over_borders(columns));
  for (int i = 0; i < 60; ++i) many.step();
  EXPECT_FALSE(many.have_met(0, 2));
  return many.parcels();
}

TEST(SeamPartners, ParcelsOfANodeDoNotGrowWithTheRow) {
  const double at_a_border = static_cast<double>(parcels_of(4)) / 3;
  EXPECT_NEAR(static_cast<double>(parcels_of(8)) / 7, at_a_border, 0.05 * at_a_border);
  EXPECT_NEAR(static_cast<double>(parcels_of(16)) / 15, at_a_border, 0.05 * at_a_border);
}

struct Row {
  core::Scene scene;
  std::vector<BodyRecord> bodies;
  int columns;

  CoupledWorlds worlds() const {
    return {scene, soft_step_with_blocks(kWidth_m), RegionMap::columns(static_cast<std::size_t>(columns), kWidth_m),
            bodies};
  }
  RegionWorld one() const {
    RegionWorld world(scene, soft_step_with_blocks(kWidth_m));
    world.add(bodies);
    return world;
  }
};

/// The worlds have the bits of one. Without introductions they cannot.
void expect_one_world(const Row& row, int steps) {
  RegionWorld one = row.one();
  CoupledWorlds many = row.worlds(), silent = row.worlds();
  silent.silence();
  bool any_introduced = false;
  const auto compute_in_silence = [&] {
    for (int i = 0; i < steps; ++i) silent.step();
  };
  for (int i = 0; i < steps; ++i) {
    one.step();
    many.step();
    any_introduced = any_introduced || many.introductions() > 0;
    const std::vector<BodyRecord> all = many.records();
    ASSERT_EQ(all.size(), one.records().size()) << "state " << i + 1;
    ASSERT_EQ(different(all, one.records()), std::vector<std::uint64_t>{}) << "state " << i + 1;
  }
  EXPECT_TRUE(any_introduced);
  EXPECT_ANY_THROW(compute_in_silence());
}

/// A plate over five of eight columns lies on balls of each of them.
TEST(SeamPartners, AGiantOverFiveColumns) {
  Row row{small_and({4 * kWidth_m + 2, 3, 0.2}), {}, 8};
  for (int i = 0; i < 40; ++i) {
    const Vec3 p(kWidth_m * (i / 40.0 - 0.5) * 5, 1.1 * (i % 3 - 1), 0.25);
    row.bodies.push_back(body(row.bodies.size() + 1, 0, p));
    row.bodies.push_back(body(row.bodies.size() + 1, 0, p + Vec3(0.1, 0, 0.8)));
  }
  row.bodies.push_back(body(1000, 1, {0.5 * kWidth_m, 0, 0.62}));
  expect_one_world(row, 120);
  CoupledWorlds many = row.worlds();
  many.step();
  EXPECT_TRUE(many.have_met(2, 6));
  EXPECT_FALSE(many.have_met(0, 6));
}

/// Planks that overlap like tiles, from column to column. None is longer than a column is wide.
TEST(SeamPartners, AChainOfPlanksOverEightColumns) {
  constexpr double kPlank_m = 5;
  Row row{small_and({kPlank_m, 0.5, 0.2}), {}, 8};
  for (int i = 0; i < 14; ++i) {
    const Vec3 p(0.8 * kPlank_m * (i - 6.5), 0, i % 2 == 0 ? 0.1 : 0.3);
    row.bodies.push_back(body(static_cast<std::uint64_t>(i + 1), 1, p));
  }
  row.bodies.push_back(body(100, 0, {1, 0, 2}));
  expect_one_world(row, 90);
}

/// Faster than promised, the one by a factor of 150: it passes three columns in a state.
TEST(SeamPartners, ABodyFasterThanPromised) {
  Row row{small_and({1, 1, 1}), balls_over_borders(8), 8};
  row.bodies.push_back(body(1000, 1, {-3 * kWidth_m, 0.1, 0.6}, {1500, 0, 0}));
  row.bodies.push_back(body(1001, 1, {3.5 * kWidth_m, 0.6, 0.9}, {-120, 0, 0}));
  expect_one_world(row, 60);
}

/// Two bodies far from home meet over a region between theirs.
TEST(SeamPartners, TwoFastBodiesMeetOverAThirdRegion) {
  Row row{small_and({1, 1, 1}), {}, 5};
  row.bodies.push_back(body(1, 0, {-1.2 * kWidth_m, 0, 1}, {1100, 0, 0}));
  row.bodies.push_back(body(2, 0, {1.2 * kWidth_m, 0.1, 1}, {-1100, 0, 0}));
  expect_one_world(row, 20);
}

}  // namespace
}  // namespace aurasim::physics::testing
