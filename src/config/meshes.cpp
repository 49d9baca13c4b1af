#include "config/meshes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <system_error>
#include <tuple>

#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "config/convex_parts.h"
#include "core/fnv1a.h"

namespace aurasim::config {
namespace {

using core::TriangleMesh;
using core::Vec3;

constexpr std::uintmax_t kLargestMeshBytes = 256u << 20;
constexpr std::size_t kMostTriangles = 1'000'000;
constexpr std::size_t kMostHullPoints = 200;
constexpr double kFarthest = 1e7;
constexpr unsigned kMostCorners = 1000;  ///< most corners of a face: the time to triangulate it grows with their square
constexpr std::size_t kDeepestNesting = 100;  ///< deepest nesting of a glTF's JSON, which assimp reads by recursion
const std::set<std::string> kFormats = {".obj", ".stl", ".gltf", ".glb"};
const std::string kUnknownFormat = "its name ends neither in .obj, .stl, .gltf nor .glb";

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string reason_not_to_read(const std::filesystem::path& file) {
  if (!kFormats.contains(lower_extension(file))) return kUnknownFormat;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return "no such file";
  if (!std::filesystem::is_regular_file(file, error)) return "it is not a regular file";
  const auto size = std::filesystem::file_size(file, error);
  if (error) return error.message();
  if (size > kLargestMeshBytes) return fmt::format("it has {} bytes, at most {} are read", size, kLargestMeshBytes);
  return "";
}

/// Joins equal points and drops triangles that have lost an edge by it.
class MeshBuilder {
 public:
  explicit MeshBuilder(const MeshRequest& request) : request_(request) {}

  void add(const aiMesh& part) {
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      const std::array<std::uint32_t, 3> t = {index_of(part.mVertices[face.mIndices[0]]),
                                              index_of(part.mVertices[face.mIndices[1]]),
                                              index_of(part.mVertices[face.mIndices[2]])};
      if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) mesh_.triangles.push_back(t);
    }
  }

  bool is_finite() const { return is_finite_; }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t index_of(const aiVector3D& v) {
    const Vec3 raw(v.x, v.y, v.z);
    const Vec3 turned = request_.up == UpAxis::kY ? Vec3(raw.x(), -raw.z(), raw.y()) : raw;
    const Vec3 p = turned.cwiseProduct(request_.scale) + Vec3::Zero();  // no negative zero
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest) {
      is_finite_ = false;
      return 0;
    }
    const auto [at, is_new] = index_.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(index_.size()));
    if (is_new) mesh_.points.push_back(p);
    return at->second;
  }

  const MeshRequest& request_;
  TriangleMesh mesh_;
  std::map<std::tuple<double, double, double>, std::uint32_t> index_;
  bool is_finite_ = true;
};

unsigned most_corners(const aiScene& scene) {
  unsigned most = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    for (unsigned f = 0; f < part.mNumFaces; ++f) most = std::max(most, part.mFaces[f].mNumIndices);
  }
  return most;
}

/// How deep brackets are nested outside of strings. For bytes that are no JSON the result has no meaning, but is never
/// less than the depth that a JSON parser would reach.
std::size_t nesting_of(std::string_view json) {
  std::size_t depth = 0, deepest = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') ++i;
    if (c == '"') in_text = !in_text;
    if (in_text) continue;
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return deepest;
}

std::variant<TriangleMesh, std::string> triangles_of(Assimp::Importer& importer, const std::string& file,
                                                     const MeshRequest& request) {
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file, 0);
  if (scene == nullptr) return fmt::format("it cannot be read: {}", importer.GetErrorString());
  if (const unsigned corners = most_corners(*scene); corners > kMostCorners)
    return fmt::format("it has a face of {} corners, at most {}", corners, kMostCorners);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (scene == nullptr) return fmt::format("it cannot be read: {}", importer.GetErrorString());
  std::size_t triangles = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) triangles += scene->mMeshes[m]->mNumFaces;
  if (triangles > kMostTriangles) return fmt::format("it has {} triangles, at most {}", triangles, kMostTriangles);
  MeshBuilder builder(request);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) builder.add(*scene->mMeshes[m]);
  if (!builder.is_finite()) return fmt::format("it has points that are no numbers or beyond {} m", kFarthest);
  TriangleMesh mesh = builder.take();
  if (mesh.triangles.empty()) return "it has no triangles";
  return mesh;
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
Vec3 direction(std::size_t i, std::size_t count) {
  const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
  const double angle = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

UpAxis usual_up_axis(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".gltf" || extension == ".glb" ? UpAxis::kY : UpAxis::kZ;
}

std::variant<TriangleMesh, std::string> load_mesh(const MeshRequest& request) {
  if (std::string why = reason_not_to_read(request.file); !why.empty()) return why;
  Assimp::Importer importer;
  return triangles_of(importer, request.file.string(), request);
}

std::variant<TriangleMesh, std::string> read_mesh(const std::string& name, std::string_view bytes) {
  const std::string extension = lower_extension(name);
  if (!kFormats.contains(extension)) return kUnknownFormat;
  if (extension == ".gltf" && nesting_of(bytes) > kDeepestNesting)
    return fmt::format("its brackets are nested deeper than {}", kDeepestNesting);
  Assimp::Importer importer;
  // Has no file system below it. The importer takes ownership.
  importer.SetIOHandler(
      new Assimp::MemoryIOSystem(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), nullptr));
  MeshRequest request;
  request.up = usual_up_axis(name);
  return triangles_of(importer, AI_MEMORYIO_MAGIC_FILENAME + extension, request);
}

std::vector<Vec3> hull_points(const TriangleMesh& mesh) {
  if (mesh.points.size() <= kMostHullPoints) return mesh.points;
  std::set<std::size_t> extreme;
  for (std::size_t i = 0; i < kMostHullPoints; ++i) {
    const Vec3 d = direction(i, kMostHullPoints);
    const auto farthest = std::max_element(mesh.points.begin(), mesh.points.end(),
                                           [&](const Vec3& a, const Vec3& b) { return a.dot(d) < b.dot(d); });
    extreme.insert(static_cast<std::size_t>(farthest - mesh.points.begin()));
  }
  std::vector<Vec3> points;
  for (const std::size_t i : extreme) points.push_back(mesh.points[i]);
  return points;
}

Vec3 centre_of_mass(const TriangleMesh& mesh) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : mesh.points) mean += p / static_cast<double>(mesh.points.size());
  double volume = 0;  // six times the volume of the tetrahedra between `mean` and the triangles
  Vec3 moment = Vec3::Zero();
  double size = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]] - mean, b = mesh.points[t[1]] - mean, c = mesh.points[t[2]] - mean;
    const double part = a.dot(b.cross(c));
    volume += part;
    moment += part * (a + b + c) / 4;
    size = std::max({size, a.norm(), b.norm(), c.norm()});
  }
  if (std::abs(volume) < 1e-9 * size * size * size) return mean;
  return mean + moment / volume;
}

std::uint64_t content_hash(std::string_view bytes) {
  core::Fnv1a hash;
  hash.add_text(bytes);
  return hash.value();
}

core::Shape shape_for(const core::TriangleMesh& mesh, core::MeshUse use) {
  if (use == core::MeshUse::kTriangles) return mesh;
  if (use == core::MeshUse::kDecomposition) return convex_parts(mesh);
  core::ConvexHull hull{hull_points(mesh)};
  const core::Vec3 centre = centre_of_mass(mesh);
  for (core::Vec3& p : hull.points) p -= centre;
  return hull;
}

}  // namespace aurasim::config
