// Mesh files by themselves.
#include "import/imported.h"
#include "import/mesh_shapes.h"

namespace aurasim::importing {
namespace {

TEST(Meshes, WithoutAMassAFileIsAStaticThatTheSceneNames) {
  const Model model = model_of("meshes/angle.obj");
  ASSERT_EQ(model.links.size(), 1u);
  EXPECT_TRUE(model.links.front().is_static);
  EXPECT_TRUE(std::holds_alternative<MeshFile>(model.links.front().collisions.front().geometry));
  EXPECT_TRUE(std::holds_alternative<core::TriangleMesh>(scene_of(model).shapes.front().shape));
}

TEST(Meshes, ColladaIsWrittenBesideTheScene) {
  const Model model = model_of("meshes/pyramid.dae");
  const SceneText text = scene_text(model, {{}}, "out/world.yaml");
  ASSERT_EQ(text.meshes.size(), 1u);
  EXPECT_EQ(text.meshes.front().first.string(), "world_meshes/pyramid.obj");
  EXPECT_EQ(std::get<core::TriangleMesh>(scene_of(model).shapes.front().shape).triangles.size(), 4u);
}

/// Its nodes are posed and scaled, and its y axis is up, as glTF has it.
TEST(Meshes, GltfIsTurnedUpright) {
  const Model model = read_model(kModels / "meshes/corner.gltf", {.paths = {}, .mass_kg = 6});
  const core::Scene scene = scene_of(model);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_LT(distance(scene.bodies.front().pose.p_WB, core::Vec3(0.5, 0.75, 1.5)), 1e-9);
  const auto mesh = read_triangles(kModels / "meshes/corner.gltf", core::Vec3::Ones());
  core::Vec3 low = core::Vec3::Constant(9), high = -low;
  for (const core::Vec3& p : std::get<core::TriangleMesh>(mesh).points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  EXPECT_LT(distance(low, core::Vec3(0, 0, 1)), 1e-9);
  EXPECT_LT(distance(high, core::Vec3(2, 3, 3)), 1e-9);
}

TEST(Meshes, WithAMassAFileIsABodyAboutItsCentre) {
  const Model model = read_model(kModels / "meshes/wedge.obj", {.paths = {}, .mass_kg = 3});
  const core::Scene scene = scene_of(model);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.prototypes.front().mass_kg, 3);
  EXPECT_LT(distance(scene.bodies.front().pose.p_WB, core::Vec3(1.0 / 3, 0.5, 0.5 / 3)), 1e-9);
}

TEST(Meshes, AHollowBodyIsTakenApart) {
  Model model;
  const auto mesh = read_triangles(kModels / "meshes/angle.obj", core::Vec3::Ones());
  EXPECT_EQ(convex_shapes(std::get<core::TriangleMesh>(mesh), "mesh", model).size(), 2u);
  EXPECT_EQ(model.lost.size(), 1u);
}

TEST(Meshes, PartsStayWhereTheyAreInTheFile) {
  Model model;
  const auto mesh = read_triangles(kModels / "meshes/angle.obj", core::Vec3::Ones());
  core::Vec3 low = core::Vec3::Constant(9), high = -low;
  for (const core::ConvexHull& hull : convex_shapes(std::get<core::TriangleMesh>(mesh), "mesh", model)) {
    for (const core::Vec3& p : hull.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  EXPECT_LT(distance(low, core::Vec3(0, 0, 0)), 1e-3);
  EXPECT_LT(distance(high, core::Vec3(1, 0.4, 1)), 1e-3);
}

}  // namespace
}  // namespace aurasim::importing
