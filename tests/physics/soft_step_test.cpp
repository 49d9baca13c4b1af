// The soft step: what it is exact in, and what stands.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

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
  const double exact = 1e-9;
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

/// A tower whose load is many times the weight of one sinks less than its springs would let it if they were those of a
/// card house.
TEST(SoftStep, WhatBearsMuchGivesWayLess) {
  constexpr int kBoxes = 30;
  const core::Scene scene = scene_of(core::Box{});
  RegionWorld world(scene, soft_settings());
  std::vector<core::BodyRecord> tower;
  for (int i = 0; i < kBoxes; ++i) tower.push_back(body(static_cast<std::uint64_t>(i), 0, {0, 0, i + 0.5}));
  world.add(tower);
  run(world, 300);
  const double sunk = kBoxes - 0.5 - world.records().back().p_WB.z();
  // Two boxes are as one of half their mass: a contact gives way by 2 g / (2 pi f)^2 for each box above; f is 1.5 times
  // the steps' rate.
  const double light = 2 * 9.81 / std::pow(2 * 3.14159 * 1.5 * 60, 2) * kBoxes * (kBoxes - 1) / 2;
  EXPECT_LT(sunk, 0.8 * light);
}

}  // namespace
}  // namespace aurasim::physics::testing
