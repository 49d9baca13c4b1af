#include "config/meshes.h"

#include <cmath>

#include <fmt/format.h>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

const std::filesystem::path kMeshes = std::filesystem::path(AURASIM_SOURCE_DIR) / "tests/config/meshes";

core::TriangleMesh mesh_of(const std::string& file, const std::string& rest = "") {
  return std::get<core::TriangleMesh>(shape_of("{mesh: {file: " + (kMeshes / file).string() + rest + "}}"));
}

/// Six times the volume inside.
double volume6(const core::TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) sum += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]]));
  return sum;
}

TEST(Meshes, AllFormatsGiveTheSameWedge) {
  for (const char* file : {"wedge.obj", "wedge.stl", "wedge.gltf"}) {
    SCOPED_TRACE(file);
    const core::TriangleMesh mesh = mesh_of(file);
    EXPECT_EQ(mesh.points.size(), 6u);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    EXPECT_NEAR(volume6(mesh), 6 * 3, 1e-6) << "2 x 3 x 1, halved; triangles face outwards";
    double highest = 0;
    for (const core::Vec3& p : mesh.points) highest = std::max(highest, p.z());
    EXPECT_EQ(highest, 1) << "z is up";
  }
}

TEST(Meshes, ScaleAndUpAxisAreApplied) {
  EXPECT_NEAR(volume6(mesh_of("wedge.obj", ", scale: 2")), 6 * 24, 1e-6);
  EXPECT_NEAR(volume6(mesh_of("wedge.obj", ", scale: [1, 2, 3]")), 6 * 18, 1e-6);
  double highest = 0;
  for (const core::Vec3& p : mesh_of("wedge.obj", ", up: y").points) highest = std::max(highest, p.z());
  EXPECT_EQ(highest, 3);
}

TEST(Meshes, AHullCanBeMovedToItsCentreOfMass) {
  const std::string file = (kMeshes / "wedge.obj").string();
  const auto as_is = std::get<core::ConvexHull>(shape_of("{convex_hull: {mesh: " + file + "}}"));
  const auto moved = std::get<core::ConvexHull>(shape_of("{convex_hull: {mesh: " + file + ", recentre: true}}"));
  ASSERT_EQ(as_is.points.size(), 6u);
  ASSERT_EQ(moved.points.size(), 6u);
  const core::Vec3 centre_of_mass(2.0 / 3, 1.5, 1.0 / 3);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT((as_is.points[i] - centre_of_mass - moved.points[i]).norm(), 1e-9);
}

TEST(Meshes, AHullOfManyPointsKeepsItsExtremes) {
  const Workspace workspace;
  std::string obj;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double u = i * 0.157, v = 0.04 + j * 0.078;
      obj += "v " + std::to_string(std::sin(v) * std::cos(u)) + " " + std::to_string(std::sin(v) * std::sin(u)) + " " +
             std::to_string(std::cos(v)) + "\n";
    }
  }
  for (int i = 1; i + 41 < 1600; i += 1)
    obj += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 41) + "\n";
  workspace.write("sphere.obj", obj);
  const auto scene = workspace.scene("shapes: {it: {convex_hull: {mesh: sphere.obj}}}\n");
  const auto hull = std::get<core::ConvexHull>(scene.shapes[0].shape);
  EXPECT_LE(hull.points.size(), 200u);
  EXPECT_GE(hull.points.size(), 100u);
  for (const core::Vec3& d : {core::Vec3(1, 0, 0), core::Vec3(0, 1, 0), core::Vec3(-1, -1, 1), core::Vec3(0, 0, -1)}) {
    double farthest = 0;
    for (const core::Vec3& p : hull.points) farthest = std::max(farthest, p.dot(d.normalized()));
    EXPECT_GT(farthest, 0.97);
  }
}

TEST(Meshes, AFaceOfVeryManyCornersIsRefusedAtOnce) {
  std::string circle;
  std::string face = "f";
  for (int i = 0; i < 60'000; ++i) {
    circle += fmt::format("v {} {} 0\n", std::cos(i * 1e-4), std::sin(i * 1e-4));
    face += fmt::format(" {}", i + 1);
  }
  const auto read = read_mesh("circle.obj", circle + face + "\n");
  ASSERT_TRUE(std::holds_alternative<std::string>(read));
  EXPECT_EQ(std::get<std::string>(read), "it has a face of 60000 corners, at most 1000");
}

TEST(Meshes, NestingIsRefusedBeforeItIsRead) {
  const auto why = [](const std::string& text) {
    const auto read = read_mesh("a.gltf", text);
    const auto* refused = std::get_if<std::string>(&read);
    return refused == nullptr ? std::string() : *refused;
  };
  EXPECT_EQ(why(std::string(200'000, '[')), "its brackets are nested deeper than 100");
  EXPECT_NE(why("{\"asset\": \"" + std::string(200'000, '[') + "\"}"), "its brackets are nested deeper than 100")
      << "within a text they are letters";
}

TEST(Meshes, BrokenFilesAreRefused) {
  const Workspace workspace;
  const auto errors = [&](const std::string& name, const std::string& bytes) {
    workspace.write(name, bytes);
    return workspace.scene_errors("shapes: {it: {mesh: {file: " + name + "}}}\n");
  };
  expect_errors(errors("empty.obj", ""),
                {"scene.yaml:1:28: shapes.it.mesh.file: found \"empty.obj\", allowed: a mesh"});
  expect_errors(errors("points.obj", "v 0 0 0\nv 1 0 0\n"), {"scene.yaml:1:28: shapes.it.mesh.file"});
  expect_errors(errors("index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 99\n"), {"scene.yaml:1:28: shapes.it.mesh.file"});
  expect_errors(errors("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), {"scene.yaml:1:28: shapes.it.mesh.file"});
  expect_errors(errors("rubbish.glb", std::string(200, '\xee')), {"scene.yaml:1:28: shapes.it.mesh.file"});
  expect_errors(errors("rubbish.stl", std::string(200, '\xee')), {"scene.yaml:1:28: shapes.it.mesh.file"});
}

}  // namespace
}  // namespace aurasim::config
