#include "config/workspace.h"

namespace aurasim::config {
namespace {

constexpr double kTiny = 1e-12;

std::vector<core::InitialBody> generated(const std::string& generator,
                                         const std::string& shape = "{box: {size: [2, 1, 1]}}") {
  const Workspace workspace;
  return workspace.scene("prototypes: {brick: {shape: " + shape + ", mass: 1}}\ngenerators:\n  - " + generator + "\n")
      .bodies;
}

void expect_at(const core::InitialBody& body, double x, double y, double z) {
  EXPECT_LT((body.pose.p_WB - core::Vec3(x, y, z)).norm(), kTiny) << body.pose.p_WB.transpose();
}

TEST(Generators, AStackStandsOnItsPosition) {
  const auto bodies = generated("stack: {prototype: brick, count: 3, position: [5, 6, 7]}");
  ASSERT_EQ(bodies.size(), 3u);
  expect_at(bodies[0], 5, 6, 7.5);
  expect_at(bodies[2], 5, 6, 9.5);
}

TEST(Generators, APyramidLosesOneBodyPerRow) {
  const auto bodies = generated("pyramid: {prototype: brick, rows: 3, gap: 0.2}");
  ASSERT_EQ(bodies.size(), 6u);
  expect_at(bodies[0], -2.2, 0, 0.5);
  expect_at(bodies[2], 2.2, 0, 0.5);
  expect_at(bodies[5], 0, 0, 2.5);
}

TEST(Generators, AWallIsLaidInBond) {
  const auto bodies = generated("wall: {prototype: brick, rows: 2, columns: 2, yaw_deg: 90}");
  ASSERT_EQ(bodies.size(), 4u);
  expect_at(bodies[0], 0, -1, 0.5);
  expect_at(bodies[1], 0, 1, 0.5);
  expect_at(bodies[2], 0, 0, 1.5);
  EXPECT_TRUE((bodies[0].pose.q_WB * core::Vec3::UnitX()).isApprox(core::Vec3::UnitY()));
}

TEST(Generators, ABlockTouchesUnlessSpaced) {
  const auto touching = generated("block: {prototype: brick, counts: [2, 1, 2]}");
  ASSERT_EQ(touching.size(), 4u);
  expect_at(touching[0], -1, 0, 0.5);
  expect_at(touching[3], 1, 0, 1.5);
  const auto spaced =
      generated("block: {prototype: brick, counts: [1, 2, 2], spacing: [9, 4, 3], velocity: [1, 0, 0]}");
  expect_at(spaced[3], 0, 2, 3.5);
  EXPECT_EQ(spaced[3].v_WB.x(), 1);
}

TEST(Generators, ARowStartsAtItsPosition) {
  const auto bodies = generated("row: {prototype: brick, count: 3, step: [0, 2, 0], position: [1, 1, 1]}");
  expect_at(bodies[0], 1, 1, 1);
  expect_at(bodies[2], 1, 5, 1);
}

TEST(Generators, AShapeOffItsOriginStandsOnTheGroundAllTheSame) {
  const auto bodies = generated("stack: {prototype: brick, count: 2}",
                                "{convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 2]]}}");
  expect_at(bodies[0], -0.5, -0.5, 0);
  expect_at(bodies[1], -0.5, -0.5, 2);
}

TEST(Generators, ACompoundIsAsHighAsItsParts) {
  const auto bodies =
      generated("stack: {prototype: brick, count: 2}",
                "{compound: {parts: [{sphere: {radius: 1}, position: [0, 0, 1]}, {capsule: {radius: 0.5, "
                "height: 1}, position: [0, 0, -1], orientation: {rpy_deg: [90, 0, 0]}}]}}");
  expect_at(bodies[0], 0, 0, 1.5);
  expect_at(bodies[1], 0, 0, 5);
}

}  // namespace
}  // namespace aurasim::config
