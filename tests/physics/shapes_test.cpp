// Every shape falls on every ground and comes to rest on its surface, not above or below it.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::Pose;
using core::Vec3;

/// Height of the lowest point of a shape in a pose.
struct Lowest {
  Pose pose;

  double operator()(const core::Sphere& s) const { return pose.p_WB.z() - s.radius; }
  double operator()(const core::Box& s) const { return pose.p_WB.z() - down_in_body().cwiseAbs().dot(s.half_extents); }
  double operator()(const core::Capsule& s) const {
    return pose.p_WB.z() - std::abs(down_in_body().z()) * s.height / 2 - s.radius;
  }
  double operator()(const core::Cylinder& s) const {
    const Vec3 down = down_in_body();
    return pose.p_WB.z() - std::abs(down.z()) * s.height / 2 - std::hypot(down.x(), down.y()) * s.radius;
  }
  double operator()(const core::ConvexHull& s) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Vec3& point : s.points) lowest = std::min(lowest, (pose.p_WB + pose.q_WB * point).z());
    return lowest;
  }
  double operator()(const core::Compound& s) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const core::CompoundPart& part : s.parts) {
      const Pose of_part{pose.p_WB + pose.q_WB * part.pose.p_WB, pose.q_WB * part.pose.q_WB};
      lowest = std::min(lowest, std::visit(Lowest{of_part}, part.shape));
    }
    return lowest;
  }
  double operator()(const core::TriangleMesh&) const { return 0; }
  double operator()(const core::Plane&) const { return 0; }

  Vec3 down_in_body() const { return pose.q_WB.conjugate() * -Vec3::UnitZ(); }
};

class EveryShape : public ::testing::TestWithParam<std::tuple<int, Ground>> {};

TEST_P(EveryShape, ComesToRestOnTheSurface) {
  const auto [kind, ground] = GetParam();
  const core::Scene scene = scene_of_all_shapes(ground);
  RegionWorld world(scene, Settings{});
  core::BodyRecord falling = body(1, kind, {0.7, 0.4, 1.5});
  falling.R_WB = core::Quat(1, 0.3, 0.2, 0.1).normalized().toRotationMatrix();
  world.add(std::span(&falling, 1));
  run(world, 900);
  const core::BodyState& state = world.snapshot().bodies[0];
  EXPECT_LT(state.v_WB.norm(), 0.01);
  const double lowest = std::visit(Lowest{state.pose}, scene.shapes[static_cast<std::size_t>(kind)].shape);
  EXPECT_NEAR(lowest, 0, 0.003);
}

INSTANTIATE_TEST_SUITE_P(OnEveryGround, EveryShape,
                         ::testing::Combine(::testing::Range(0, int{kKinds}),
                                            ::testing::Values(Ground::kPlane, Ground::kMesh)),
                         [](const auto& info) {
                           const char* const ground = std::get<1>(info.param) == Ground::kPlane ? "Plane" : "Mesh";
                           return std::string(kKindNames[std::get<0>(info.param)]) + "On" + ground;
                         });

TEST(Shapes, APlaneMayBeTiltedAndGivenByANormalOfAnyLength) {
  core::Scene scene = scene_of(core::Sphere{0.5});
  scene.shapes[1].shape = core::Plane{{0, 0, 4}, 8};  // z = 2
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, 0, {0, 0, 3})});
  run(world, 200);
  EXPECT_NEAR(world.snapshot().bodies[0].pose.p_WB.z(), 2.5, 0.003);
}

TEST(Shapes, AStaticStandsInItsPose) {
  core::Scene scene = scene_of(core::Sphere{0.5});
  scene.shapes.push_back({"slab", core::Box{{2, 2, 0.5}}});
  core::StaticBody slab;
  slab.shape = 2;
  slab.pose.p_WB = {10, 0, 3};
  scene.statics.push_back(slab);
  RegionWorld world(scene, Settings{});
  world.add(std::vector{body(1, 0, {10, 0, 4.5})});
  run(world, 200);
  EXPECT_NEAR(world.snapshot().bodies[0].pose.p_WB.z(), 4, 0.003);
}

TEST(Shapes, PlanesAndMeshesCannotMove) {
  EXPECT_THROW(RegionWorld(scene_of(core::Plane{}), Settings{}), std::invalid_argument);
  EXPECT_THROW(RegionWorld(scene_of(core::TriangleMesh{}), Settings{}), std::invalid_argument);
}

}  // namespace
}  // namespace aurasim::physics::testing
