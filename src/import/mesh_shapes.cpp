#include "import/mesh_shapes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "config/convex_parts.h"
#include "config/meshes.h"

namespace aurasim::importing {
namespace {

using core::TriangleMesh;
using core::Vec3;

constexpr std::uintmax_t kLargestColladaBytes = 64u << 20;
constexpr std::size_t kMostColladaTriangles = 1'000'000;
constexpr int kEllipsoidPoints = 200;

bool is_collada(const std::filesystem::path& file) { return ending_of(file) == ".dae"; }

/// Joins equal points, and drops triangles without an area.
TriangleMesh joined(const aiScene& scene, const Vec3& scale) {
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      mesh.points.push_back(Vec3(p.x, p.y, p.z).cwiseProduct(scale));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  return mesh;
}

std::variant<TriangleMesh, std::string> read_collada(const std::filesystem::path& file, const Vec3& scale) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return error.message();
  if (size > kLargestColladaBytes) return fmt::format("it has {} bytes, at most {}", size, kLargestColladaBytes);
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_PreTransformVertices |
                                           aiProcess_DropNormals | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr) return fmt::format("it cannot be read: {}", importer.GetErrorString());
  TriangleMesh mesh = joined(*scene, scale);
  if (mesh.triangles.empty()) return "it has no triangles";
  if (mesh.triangles.size() > kMostColladaTriangles)
    return fmt::format("it has {} triangles, at most {}", mesh.triangles.size(), kMostColladaTriangles);
  if (!std::ranges::all_of(mesh.points, [](const Vec3& p) { return p.allFinite(); }))
    return "it has points that are no numbers";
  return mesh;
}

}  // namespace

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::variant<TriangleMesh, std::string> read_triangles(const std::filesystem::path& file, const Vec3& scale) {
  if (is_collada(file)) return read_collada(file, scale);
  return config::load_mesh({file, scale, config::usual_up_axis(file)});
}

core::ConvexHull hull_of_points(const TriangleMesh& mesh) { return {config::hull_points(mesh)}; }

std::vector<core::ConvexHull> convex_shapes(const TriangleMesh& mesh, const std::string& element, Model& model) {
  const auto taken_apart = config::decompose(mesh);
  if (const auto* why = std::get_if<std::string>(&taken_apart)) {
    model.lose(element, fmt::format("its mesh: {}; its convex hull stands for it", *why));
    return {hull_of_points(mesh)};
  }
  const auto& pieces = std::get<TriangleMesh>(taken_apart);
  const Vec3 centre = config::centre_of_mass(pieces);
  std::vector<core::ConvexHull> hulls;
  std::size_t points = 0;
  for (const core::CompoundPart& part : config::convex_parts(pieces).parts) {
    core::ConvexHull hull = std::get<core::ConvexHull>(part.shape);
    for (Vec3& p : hull.points) p += centre;
    points += hull.points.size();
    hulls.push_back(std::move(hull));
  }
  if (hulls.size() > 1) {
    model.lose(element, fmt::format("its mesh is not convex: {} convex parts stand for it", hulls.size()));
  } else if (points < pieces.points.size()) {
    model.lose(element,
               fmt::format("its mesh: a hull of {} of its {} points stands for it", points, pieces.points.size()));
  }
  return hulls;
}

core::ConvexHull ellipsoid_hull(const Vec3& half_axes) {
  core::ConvexHull hull;
  for (int i = 0; i < kEllipsoidPoints; ++i) {  // Fibonacci lattice
    const double z = 1 - (2.0 * i + 1) / kEllipsoidPoints;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    hull.points.push_back(half_axes.cwiseProduct(Vec3(r * std::cos(angle), r * std::sin(angle), z)));
  }
  return hull;
}

std::string obj_text(const core::TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.points) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

TriangleMesh add_mesh(const std::filesystem::path& file, const Vec3& scale, Collision collision,
                      const std::string& element, Link& link, Model& model) {
  auto read = read_triangles(file, scale);
  if (const auto* why = std::get_if<std::string>(&read))
    throw BadModel({fmt::format("{}: {}: {}", file.string(), element, *why)});
  auto& mesh = std::get<TriangleMesh>(read);
  if (link.is_static) {
    const bool reader_takes_it = !is_collada(file) && scale.minCoeff() > 0;
    collision.geometry = reader_takes_it ? Geometry(MeshFile{file, scale}) : Geometry(mesh);
    link.collisions.push_back(std::move(collision));
    return std::move(mesh);
  }
  for (core::ConvexHull& hull : convex_shapes(mesh, element, model)) {
    collision.geometry = std::move(hull);
    link.collisions.push_back(collision);
  }
  return std::move(mesh);
}

}  // namespace aurasim::importing
