#include "config/workspace.h"

namespace aurasim::config {
namespace {

core::InitialBody body_of(const std::string& rest) {
  const Workspace workspace;
  return workspace
      .scene("prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1}}\nbodies: [{prototype: ball, " + rest + "}]\n")
      .bodies.at(0);
}

TEST(SceneFile, AnEmptyMapIsAnEmptyWorld) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene("{}\n");
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.gravity, core::Vec3(0, 0, -9.81));
  EXPECT_TRUE(scene.bodies.empty());
}

TEST(SceneFile, ShapesHaveTheirSizes) {
  EXPECT_EQ(std::get<core::Sphere>(shape_of("{sphere: {radius: 0.3}}")).radius, 0.3);
  EXPECT_EQ(std::get<core::Box>(shape_of("{box: {size: [1, 2, 4]}}")).half_extents, core::Vec3(0.5, 1, 2));
  EXPECT_EQ(std::get<core::Cylinder>(shape_of("{cylinder: {radius: 1, height: 3}}")).height, 3);
  const auto plane = std::get<core::Plane>(shape_of("{plane: {normal: [0, 3, 4], offset: -1}}"));
  EXPECT_EQ(plane.normal, core::Vec3(0, 0.6, 0.8));
  EXPECT_EQ(plane.offset, -1);
}

TEST(SceneFile, ACapsuleIsMeasuredBetweenItsCapsOrOverall) {
  EXPECT_EQ(std::get<core::Capsule>(shape_of("{capsule: {radius: 0.25, height: 1.5}}")).height, 1.5);
  EXPECT_EQ(std::get<core::Capsule>(shape_of("{capsule: {radius: 0.25, total_height: 2}}")).height, 1.5);
}

TEST(SceneFile, ACompoundHasPlacedParts) {
  const auto compound = std::get<core::Compound>(
      shape_of("{compound: {parts: [{sphere: {radius: 1}, position: [1, 0, 0]}, {box: {size: [1, 1, 1]}}]}}"));
  ASSERT_EQ(compound.parts.size(), 2u);
  EXPECT_EQ(compound.parts[0].pose.p_WB, core::Vec3(1, 0, 0));
  EXPECT_TRUE(std::holds_alternative<core::Box>(compound.parts[1].shape));
}

TEST(SceneFile, AStaticMayHaveAPathAndABelt) {
  const Workspace workspace;
  const std::string text =
      "statics: [{shape: {box: {size: [1, 1, 1]}}, position: [5, 0, 0], belt: [0, 2, 0], path: {smooth: false, "
      "stops: [{at: 2, position: [0, 0, 3]}, {at: 4}]}}, {shape: {sphere: {radius: 1}}}]\n";
  const core::StaticList statics = workspace.scene(text).statics;
  ASSERT_TRUE(statics.at(0).path);
  EXPECT_EQ(statics[0].belt_S, core::Vec3(0, 2, 0));
  EXPECT_EQ(statics[0].pose.p_WB, core::Vec3(5, 0, 0));
  EXPECT_FALSE(statics[0].path->smooth);
  EXPECT_FALSE(statics[0].path->repeats);
  ASSERT_EQ(statics[0].path->stops.size(), 2u);
  EXPECT_EQ(statics[0].path->stops[0].at_s, 2);
  EXPECT_EQ(statics[0].path->stops[0].X_SP.p_WB, core::Vec3(0, 0, 3));
  EXPECT_TRUE(statics[0].moves());
  EXPECT_FALSE(statics.at(1).moves());
}

TEST(SceneFile, WhatMovesNeedsASolverThatKnowsIt) {
  const Workspace workspace;
  const std::string text = "statics: [{name: belt, shape: {box: {size: [1, 1, 1]}}, belt: [0, 2, 0]}]\n";
  EXPECT_NO_THROW(workspace.scene(text));
  try {
    workspace.scene(text, {"physics.solver=sequential_impulse"});
    FAIL();
  } catch (const BadConfig& bad) {
    EXPECT_THAT(bad.what(), testing::HasSubstr("the solver sequential_impulse and the static \"belt\", which moves"));
  }
}

TEST(SceneFile, AHeightfieldBecomesTrianglesAroundTheOrigin) {
  const auto mesh =
      std::get<core::TriangleMesh>(shape_of("{heightfield: {cell: [2, 4], heights: [[0, 1, 2], [3, 4, 5]]}}"));
  ASSERT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.points[0], core::Vec3(-2, -2, 0));
  EXPECT_EQ(mesh.points[5], core::Vec3(2, 2, 5));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (const auto& t : mesh.triangles) {
    const core::Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    EXPECT_GT((b - a).cross(c - a).z(), 0) << "counter-clockwise from above";
  }
}

TEST(SceneFile, OrientationsAreUnitQuaternions) {
  const core::Quat turned = body_of("orientation: {rpy_deg: [0, 0, 90]}").pose.q_WB;
  EXPECT_TRUE((turned * core::Vec3::UnitX()).isApprox(core::Vec3::UnitY()));
  const core::Quat both = body_of("orientation: {rpy_deg: [90, 0, 90]}").pose.q_WB;
  EXPECT_TRUE((both * core::Vec3::UnitY()).isApprox(core::Vec3::UnitZ())) << "roll first, then yaw";
  EXPECT_TRUE(body_of("orientation: {quaternion: [2, 0, 0, 2]}").pose.q_WB.isApprox(turned));
}

TEST(SceneFile, BodiesMoveAndSpinAsTold) {
  const core::InitialBody body = body_of("position: [1, 2, 3], velocity: [4, 5, 6], spin: [7, 8, 9]");
  EXPECT_EQ(body.pose.p_WB, core::Vec3(1, 2, 3));
  EXPECT_EQ(body.v_WB, core::Vec3(4, 5, 6));
  EXPECT_EQ(body.w_WB, core::Vec3(7, 8, 9));
}

TEST(SceneFile, BodiesWithoutAnIdGetTheLowestFreeOnesInOrder) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(R"(prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1}}
bodies:
  - {prototype: ball, id: 1, position: [10, 0, 0]}
  - {prototype: ball, position: [20, 0, 0]}
  - {prototype: ball, position: [30, 0, 0]}
  - {prototype: ball, id: 0, position: [40, 0, 0]}
generators:
  - stack: {prototype: ball, count: 1, position: [50, 0, 0]}
)");
  std::vector<std::pair<std::uint64_t, double>> found;
  for (const auto& body : scene.bodies) found.emplace_back(value_of(body.id), body.pose.p_WB.x());
  EXPECT_THAT(found, testing::ElementsAre(testing::Pair(0, 40), testing::Pair(1, 10), testing::Pair(2, 20),
                                          testing::Pair(3, 30), testing::Pair(4, 50)));
}

TEST(SceneFile, BodiesMayHaveMomentsOfTheirOwnAndTouchNothing) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(R"(shapes: {ball: {sphere: {radius: 1}}}
prototypes: {rotor: {shape: ball, mass: 2, inertia: [1, 2, 3], collides: false}, plain: {shape: ball, mass: 1}}
)");
  EXPECT_EQ(scene.prototypes[0].inertia, core::Vec3(1, 2, 3));
  EXPECT_FALSE(scene.prototypes[0].collides);
  EXPECT_FALSE(scene.prototypes[1].inertia);
  EXPECT_TRUE(scene.prototypes[1].collides);
}

TEST(SceneFile, WhatNamesNoMaterialHasTheDefaultOne) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(R"(materials: {ice: {friction: 0}}
shapes: {ball: {sphere: {radius: 1}}}
prototypes: {slick: {shape: ball, mass: 2, material: ice, can_sleep: false}, plain: {shape: ball, mass: 1}}
statics: [{shape: {plane: {}}}]
)");
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[scene.prototypes[0].material].name, "ice");
  EXPECT_FALSE(scene.prototypes[0].can_sleep);
  EXPECT_EQ(scene.materials[scene.prototypes[1].material].name, "default");
  EXPECT_EQ(scene.statics[0].material, scene.prototypes[1].material);
  EXPECT_EQ(scene.statics[0].name, "static 0");
}

TEST(SceneFile, PartsHaveMaterialsOfTheirOwn) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(R"(materials: {steel: {}, rubber: {friction: 1.1}}
prototypes:
  leg:
    material: steel
    mass: 1
    shape: {compound: {parts: [{sphere: {radius: 0.1}, material: rubber}, {box: {size: [1, 1, 1]}}]}}
)");
  const auto& parts = std::get<core::Compound>(scene.shapes[scene.prototypes[0].shape].shape).parts;
  ASSERT_TRUE(parts[0].material.has_value());
  EXPECT_EQ(scene.materials[*parts[0].material].name, "rubber");
  EXPECT_FALSE(parts[1].material.has_value()) << "the body's";
}

TEST(SceneFile, TheDefaultMaterialCanBeDefined) {
  const Workspace workspace;
  const core::Scene scene = workspace.scene(
      "materials: {default: {friction: 0.9}}\nprototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1}}\n");
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].friction, 0.9);
}

}  // namespace
}  // namespace aurasim::config
