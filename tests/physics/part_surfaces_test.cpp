// Bodies of which parts have materials of their own, against closed forms.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

constexpr std::uint32_t kIce = 1, kRubber = 2, kSpring = 3;

/// Two slabs of 1 x 1 x 0.5 m, one on the other: the body rests on the lower one.
core::Compound two_slabs(std::optional<std::uint32_t> lower, std::optional<std::uint32_t> upper) {
  const auto slab = [](double z, std::optional<std::uint32_t> material) {
    return core::CompoundPart{core::Box{{0.5, 0.5, 0.25}}, {{0, 0, z}, core::Quat::Identity()}, material};
  };
  return {{slab(-0.25, lower), slab(0.25, upper)}};
}

/// The material of bodies and statics has friction 0.6.
core::Scene scene_of_parts(const core::Compound& compound) {
  core::Scene scene = scene_of(compound);
  core::Material rough, ice, rubber, spring;
  rough.friction = 0.6, ice.friction = 0, rubber.friction = 1.2, spring.restitution = 1;
  scene.materials = {rough, ice, rubber, spring};
  return scene;
}

class PartSurfaces : public ::testing::TestWithParam<Solver> {
 protected:
  static Settings settings() {
    Settings settings;
    settings.solver = GetParam();
    settings.substeps = 8;
    return settings;
  }

  /// Where it comes to in 3 s, started at 3 m/s.
  static double slides(const core::Scene& scene, bool upside_down = false) {
    RegionWorld world(scene, settings());
    core::BodyRecord start = body(1, 0, {0, 0, 0.5}, {3, 0, 0});
    if (upside_down) start.R_WB = Vec3(1, -1, -1).asDiagonal();
    world.add(std::span(&start, 1));
    run(world, 180);
    return world.records()[0].p_WB.x();
  }

  /// Of a pair.
  static double way(double friction) { return 3.0 * 3.0 / (2 * friction * 9.81); }
};

TEST_P(PartSurfaces, FrictionIsThatOfThePartThatTouches) {
  const core::Scene scene = scene_of_parts(two_slabs(kIce, std::nullopt));
  EXPECT_NEAR(slides(scene), 9, 0.01);
  EXPECT_NEAR(slides(scene, true), way(0.6 * 0.6), 0.07);
  EXPECT_NEAR(slides(scene_of_parts(two_slabs(kRubber, kIce))), way(1.2 * 0.6), 0.07);
}

TEST_P(PartSurfaces, OfTwoCompoundsBothPartsCount) {
  core::Scene scene = scene_of_parts(two_slabs(kRubber, kIce));
  core::Compound& track = std::get<core::Compound>(scene.shapes.emplace_back("track", core::Compound{}).shape);
  const auto piece = [&track](double x, double top, std::optional<std::uint32_t> material) {
    track.parts.push_back({core::Box{{2, 2, 0.5}}, {{x, 0, top - 0.5}, core::Quat::Identity()}, material});
  };
  piece(1, 0, kIce), piece(5, -0.005, std::nullopt);  // from x = -1 to 3, a little down, to 7
  core::StaticBody ground = scene.statics[0];
  ground.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  scene.statics = {ground};
  const double from_3 = way(1.2 * 0.6);
  const double stops_at = slides(scene);  // its middle: the brake grows while it comes over the seam
  EXPECT_GT(stops_at, 2.5 + from_3 - 0.2);
  EXPECT_LT(stops_at, 3.5 + from_3 + 0.2);
}

TEST_P(PartSurfaces, RestitutionIsThatOfThePartThatTouches) {
  core::Scene scene = scene_of_parts(two_slabs(kSpring, std::nullopt));
  scene.materials[0].restitution = 0.81;
  const auto thrown_back = [](const core::Scene& with, bool upside_down) {
    RegionWorld world(with, settings());
    core::BodyRecord start = body(1, 0, {0, 0, 1.5});
    if (upside_down) start.R_WB = Vec3(1, -1, -1).asDiagonal();
    world.add(std::span(&start, 1));
    double upwards = 0;
    for (int i = 0; i < 60; ++i) {
      world.step();
      upwards = std::max(upwards, world.records()[0].v_WB.z());
    }
    return upwards;
  };
  const double impact = std::sqrt(2 * 9.81 * 1);
  EXPECT_NEAR(thrown_back(scene, false), 0.81 * impact, 0.12 * impact);
  EXPECT_NEAR(thrown_back(scene, true), 0.81 * 0.81 * impact, 0.12 * impact);
}

TEST_P(PartSurfaces, RollingIsSlowedByThePartThatRolls) {
  core::Compound ball;
  ball.parts.push_back({core::Sphere{0.5}, {}, kRubber});
  core::Scene scene = scene_of_parts(ball);
  const auto rolls = [&scene] {
    RegionWorld world(scene, settings());
    core::BodyRecord start = body(1, 0, {0, 0, 0.5}, {2, 0, 0});
    start.w_WB = {0, 4, 0};
    world.add(std::span(&start, 1));
    run(world, 60);
    return world.records()[0].v_WB.x();
  };
  EXPECT_NEAR(rolls(), 2, 0.05);
  scene.materials[kRubber].rolling_friction = 0.05;
  const double lever = 0.05 * 0.6, inertia = 1 + 2.0 / 5;  // m; of a ball that rolls, of its mass
  EXPECT_NEAR(rolls(), 2 - 9.81 * lever / 0.5 / inertia, 0.05);
}

/// What touches is a matter of the two parts alone.
TEST_P(PartSurfaces, ManyBodiesAreAsEachAlone) {
  const core::Scene scene = scene_of_parts(two_slabs(kIce, kRubber));
  const auto records_of = [&scene](const std::vector<core::BodyRecord>& bodies) {
    RegionWorld world(scene, settings());
    world.add(bodies);
    run(world, 120);
    const auto records = world.records();
    return std::vector<core::BodyRecord>(records.begin(), records.end());
  };
  std::vector<core::BodyRecord> all;
  for (std::uint64_t i = 0; i < 8; ++i) {
    all.push_back(body(i + 1, 0, {0, 5 * static_cast<double>(i), 1}, {1, 0, 0}));
    if (i % 2 == 1) all.back().R_WB = Vec3(1, -1, -1).asDiagonal();
  }
  const std::vector<core::BodyRecord> together = records_of(all);
  for (const core::BodyRecord& one : all) {
    EXPECT_TRUE(different(records_of({one}), together).empty()) << core::value_of(one.id);
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, PartSurfaces, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                         [](const auto& info) {
                           return info.param == Solver::kSoftStep ? std::string("SoftStep") : std::string("Sequential");
                         });

/// At 30 m/s the contact comes ahead of time: half a metre before the two touch.
TEST(PartSurfacesAhead, RestitutionIsThatOfThePartThatWillTouch) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  for (const bool upside_down : {false, true}) {
    core::Scene scene = scene_of_parts(two_slabs(kSpring, std::nullopt));
    scene.gravity = Vec3::Zero();
    scene.materials[0].restitution = 0.5;
    RegionWorld world(scene, settings);
    core::BodyRecord start = body(1, 0, {0, 0, 10.26}, {0, 0, -30});
    if (upside_down) start.R_WB = Vec3(1, -1, -1).asDiagonal();
    world.add(std::span(&start, 1));
    run(world, 40);
    EXPECT_NEAR(world.records()[0].v_WB.z(), (upside_down ? 0.25 : 0.5) * 30, 1) << upside_down;
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
