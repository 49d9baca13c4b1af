// Coupled regions tell each other about contacts only in steps in which a body of the one may reach a body of the other
// (physics/simulation_seams.cpp).
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "physics/coupled_worlds.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::RegionMap;
using core::Vec3;

constexpr double kBlock_m = 8, kRadius_m = 0.25;

core::Scene balls() {
  core::Scene scene = scene_of(core::Sphere{kRadius_m});
  for (core::Prototype& kind : scene.prototypes) kind.can_sleep = false;
  return scene;
}

BodyRecord ball(std::uint64_t id, double x, double y, double z = kRadius_m, const Vec3& v_WB = Vec3::Zero()) {
  return body(id, 0, {x, y, z}, v_WB);
}

/// Worlds of several regions beside the one world that they have to be.
struct Beside {
  Beside(const RegionMap& map, std::vector<BodyRecord> some)
      : bodies(std::move(some)),
        one(scene, soft_step_with_blocks(kBlock_m)),
        many(scene, soft_step_with_blocks(kBlock_m), map, bodies) {
    one.add(bodies);
  }

  /// Computes a state, and returns the number of parcels that it took.
  std::size_t step() {
    const std::size_t before = many.parcels();
    one.step();
    many.step();
    EXPECT_EQ(different(many.records(), one.records()), std::vector<std::uint64_t>{}) << "state " << one.step_number();
    return many.parcels() - before;
  }

  core::Scene scene = balls();
  std::vector<BodyRecord> bodies;
  RegionWorld one;
  CoupledWorlds many;
};

constexpr std::size_t kHalos = 2;  // of two partners

TEST(SeamReach, GuestsOutOfReachCostNoParcelsAboutContacts) {
  Beside worlds(RegionMap::columns(2, 16), {ball(1, -0.6, 0), ball(2, 0.6, 0), ball(3, -0.5, 3), ball(4, 0.5, 4)});
  for (int i = 0; i < 30; ++i) EXPECT_EQ(worlds.step(), kHalos);
}

TEST(SeamReach, BodiesThatTouchOverTheBorderAreToldOf) {
  Beside worlds(RegionMap::columns(2, 16), {ball(1, -0.25, 0), ball(2, 0.25, 0)});
  for (int i = 0; i < 30; ++i) EXPECT_GT(worlds.step(), kHalos);
}

/// The ball hits in the middle of a state: its way in the step counts, not where it is.
TEST(SeamReach, AFastBodyIsToldOfInTheStateInWhichItHits) {
  for (const double speed_m_s : {7.0, 9.0, 60.0}) {
    SCOPED_TRACE(speed_m_s);
    Beside worlds(RegionMap::columns(2, 16), {ball(1, -4, 0, 1, {speed_m_s, 0, 2}), ball(2, 0.4, 0.1, 1, {0, 0, 2})});
    bool any_apart = false, any_told = false;
    for (int i = 0; i < 60; ++i) {
      const std::size_t parcels = worlds.step();
      any_apart = any_apart || parcels == kHalos;
      any_told = any_told || parcels > kHalos;
    }
    EXPECT_TRUE(any_apart);
    EXPECT_TRUE(any_told);
  }
}

/// Many small bodies that jump about over the border of two columns, one by one or several together.
TEST(SeamReach, BodiesThatMeetNowAndThen) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<BodyRecord> bodies;
  for (std::uint64_t id = 1; id <= 40; ++id) {
    bodies.push_back(ball(id, 3 * any(random), 12 * any(random), 0.3 + std::abs(any(random)),
                          {8 * any(random), 8 * any(random), 3 * any(random)}));
  }
  Beside worlds(RegionMap::columns(2, 16), bodies);
  int apart = 0;
  for (int i = 0; i < 200; ++i) apart += worlds.step() == kHalos ? 1 : 0;
  EXPECT_GT(apart, 20);
  EXPECT_LT(apart, 180);
}

/// The middle one of three bodies around a corner touches the two others, which do not reach each other. All four
/// owners of the blocks around the corner are told of such contacts in each step.
TEST(SeamReach, AChainAroundACornerOfFourRegions) {
  Beside worlds(RegionMap::grid(2, 2, 16, 16), {ball(1, -0.3, 0.28), ball(2, 0.1, 0.2), ball(3, 0.26, -0.26)});
  for (int i = 0; i < 60; ++i) EXPECT_GE(worlds.step(), 2 * 12u);
}

}  // namespace
}  // namespace aurasim::physics::testing
