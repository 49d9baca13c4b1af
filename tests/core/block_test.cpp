#include "core/block.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/block_owners.h"
#include "core/mechanisms.h"
#include "core/scene.h"

namespace aurasim::core {
namespace {

TEST(BlockAt, CountsColumnsFromTheOrigin) {
  EXPECT_EQ(block_at({0, 0, 5}, 16), (Block{0, 0}));
  EXPECT_EQ(block_at({15.9, 16, -5}, 16), (Block{0, 1}));
  EXPECT_EQ(block_at({-0.1, -16.1, 0}, 16), (Block{-1, -2}));
}

TEST(BlockAt, HasAnAnswerForPlacesBeyondAnyWorld) {
  const double most = std::numeric_limits<double>::max();
  EXPECT_GT(block_at({most, -most, 0}, 1).x, 0);
  EXPECT_LT(block_at({most, -most, 0}, 1).y, 0);
  EXPECT_EQ(block_at({NAN, INFINITY, 0}, 1), (Block{0, 0}));
}

TEST(OutsideOfABlock, IsTheWayToItAlongTheFartherAxis) {
  EXPECT_EQ(outside_m({3, 12, 100}, {0, 0}, 16), 0);
  EXPECT_EQ(outside_m({-3, 17, 0}, {0, 0}, 16), 3);
  EXPECT_FALSE(leaves({16.5, 3, 0}, {0, 0}, 16));
  EXPECT_TRUE(leaves({16.51, 3, 0}, {0, 0}, 16));
}

TEST(BlocksAreNear, IfEachIsThatOfItsBodyOrOfAnotherOne) {
  std::vector<BodyRecord> bodies(3);
  for (BodyRecord& body : bodies) body.block = {0, 0};
  bodies[1].p_WB = {17, 0, 0};
  bodies[2].p_WB = {100, 0, 0};
  EXPECT_TRUE(blocks_are_near(bodies, 16));
  bodies[2].block = {0, 1};
  EXPECT_FALSE(blocks_are_near(bodies, 16));
  bodies[2].block = {};
  EXPECT_TRUE(blocks_are_near(bodies, 16));
}

Scene balls(std::size_t count, double radius_m) {
  Scene scene;
  scene.shapes = {{"ball", Sphere{radius_m}}, {"large", Sphere{20 * radius_m}}};
  scene.materials.resize(1);
  scene.prototypes.resize(2);
  scene.prototypes[1].shape = 1;
  for (std::size_t i = 0; i < count; ++i) {
    scene.bodies.push_back({.id = BodyId{i}, .prototype = PrototypeId{0}, .pose = {}});
    scene.bodies.back().pose.p_WB = {static_cast<double>(i), 0, 0};
  }
  return scene;
}

TEST(UsualBlock, IsAsLargeAsTheBodiesNeed) {
  EXPECT_EQ(usual_block_m({}), 16);
  EXPECT_EQ(usual_block_m(balls(10, 1.77)), 16);
  EXPECT_EQ(usual_block_m(balls(10, 1.78)), 32);
  EXPECT_EQ(usual_block_m(balls(10, 50)), 512);
  EXPECT_LE(usual_block_m(balls(10, 1e6)), kLargestBlock_m);
}

TEST(UsualBlock, HeedsNoSingleGiant) {
  Scene scene = balls(200, 0.5);
  scene.bodies[7].prototype = scene.bodies[8].prototype = PrototypeId{1};
  EXPECT_EQ(usual_block_m(scene), 16);
  scene.bodies[9].prototype = PrototypeId{1};
  EXPECT_EQ(usual_block_m(scene), 128);
}

TEST(UsualBlock, HeedsWhatIsStillToCome) {
  Scene scene = balls(10, 0.5);
  scene.injectors.resize(1);
  scene.injectors[0].max_bodies = 10;
  scene.injectors[0].prototypes = {PrototypeId{1}};
  EXPECT_EQ(usual_block_m(scene), 128);
}

TEST(UsualBlock, CountsTheReachOfJointedBodies) {
  Scene scene = balls(6, 0.5);
  for (std::uint64_t i = 0; i + 1 < scene.bodies.size(); ++i) {
    JointSpec& joint = scene.joints.emplace_back();
    joint.a = BodyId{i + 1};
    joint.b = BodyId{i};
  }
  EXPECT_EQ(usual_block_m(scene), 64);
}

TEST(Mechanisms, AreNamedByTheirFirstBody) {
  const auto joint = [](std::uint64_t a, std::optional<BodyId> b) {
    JointSpec spec;
    spec.a = BodyId{a};
    spec.b = b;
    return spec;
  };
  const std::vector<JointSpec> joints = {joint(9, BodyId{4}), joint(7, std::nullopt), joint(3, BodyId{9}),
                                         joint(20, BodyId{30}), joint(4, BodyId{20})};
  const std::vector<JointId> which = {JointId{0}, JointId{1}, JointId{2}, JointId{3}};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> found;
  for (const BoundBody& bound : mechanisms_of(joints, which)) {
    found.emplace_back(value_of(bound.body), value_of(bound.first));
  }
  EXPECT_EQ(found, (std::vector<std::pair<std::uint64_t, std::uint64_t>>{{3, 3}, {4, 3}, {9, 3}, {20, 20}, {30, 20}}));
}

TEST(BlockOwners, SayHowFarBordersAreMovedAndWhichSideMovesNone) {
  const RegionMap columns = RegionMap::columns(8, 40);  // borders at multiples of 40
  EXPECT_DOUBLE_EQ(farthest_move_m(columns, 16), 8);
  EXPECT_DOUBLE_EQ(side_that_moves_none(columns, 16).value(), 10);
  EXPECT_DOUBLE_EQ(farthest_move_m(columns, 10), 0);
  EXPECT_DOUBLE_EQ(side_that_moves_none(columns, 40).value(), 40);
  const RegionMap thirds = RegionMap::columns(2, 10.0 / 3);  // its border is at 0
  EXPECT_DOUBLE_EQ(farthest_move_m(thirds, 3), 0);
  EXPECT_FALSE(side_that_moves_none(RegionMap::columns(3, 10.0 / 3), 3)) << "not in whole millimetres";
  EXPECT_FALSE(side_that_moves_none(RegionMap::columns(3, 2), 16)) << "far shorter blocks";
  for (const double width_m : {7.0, 12.5, 33.0, 80.0}) {
    for (const double side_m : {4.0, 10.0, 16.0}) {
      const RegionMap map = RegionMap::grid(3, 4, width_m, 2 * width_m);
      const auto none_m = side_that_moves_none(map, side_m);
      if (!none_m) continue;
      EXPECT_LE(*none_m, side_m);
      EXPECT_LT(farthest_move_m(map, *none_m), 1e-9) << width_m << " " << side_m;
    }
  }
}

}  // namespace
}  // namespace aurasim::core
