#include "config/convex_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <hacdHACD.h>

#include "config/meshes.h"

namespace aurasim::config {
namespace {

using core::TriangleMesh;
using core::Vec3;

constexpr std::size_t kMostTrianglesToDivide = 4000;
constexpr std::size_t kMostParts = 64;
constexpr std::size_t kMostPointsOfAPart = 64;
constexpr double kNormalSize = 1000;    ///< of the mesh from corner to corner, as HACD sees it
constexpr double kDeepestHollow = 10;   ///< of a part that is taken for convex, in that measure
constexpr double kFarthestPieces = 30;  ///< that may share a part, in that measure

/// The mesh as HACD wants it: about its middle and of a size that its limits are meant for.
struct Scaling {
  explicit Scaling(const TriangleMesh& mesh) {
    Vec3 low = mesh.points.front(), high = low;
    for (const Vec3& p : mesh.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    middle = (low + high) / 2;
    factor = kNormalSize / std::max((high - low).norm(), 1e-12);
  }
  Vec3 middle = Vec3::Zero();
  double factor = 1;
};

void append(const TriangleMesh& part, TriangleMesh& to) {
  const auto offset = static_cast<std::uint32_t>(to.points.size());
  to.points.insert(to.points.end(), part.points.begin(), part.points.end());
  for (const auto& t : part.triangles) to.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

TriangleMesh part_of(HACD::HACD& hacd, std::size_t part, const Scaling& scaling) {
  std::vector<HACD::Vec3<HACD::Real>> points(hacd.GetNPointsCH(part));
  std::vector<HACD::Vec3<long>> triangles(hacd.GetNTrianglesCH(part));
  hacd.GetCH(part, points.data(), triangles.data());
  TriangleMesh mesh;
  for (const auto& p : points) mesh.points.push_back(Vec3(p.X(), p.Y(), p.Z()) / scaling.factor + scaling.middle);
  for (const auto& t : triangles) {
    mesh.triangles.push_back(
        {static_cast<std::uint32_t>(t.X()), static_cast<std::uint32_t>(t.Y()), static_cast<std::uint32_t>(t.Z())});
  }
  return mesh;
}

bool is_sound(const TriangleMesh& mesh) {
  const auto finite = [](const Vec3& p) { return p.allFinite(); };
  const auto inside = [&](const auto& t) { return std::max({t[0], t[1], t[2]}) < mesh.points.size(); };
  return mesh.triangles.size() >= 4 && std::ranges::all_of(mesh.points, finite) &&
         std::ranges::all_of(mesh.triangles, inside);
}

}  // namespace

std::variant<TriangleMesh, std::string> decompose(const TriangleMesh& mesh) {
  if (mesh.points.empty()) return "it has no points";
  if (mesh.triangles.size() > kMostTrianglesToDivide) {
    return fmt::format("it has {} triangles, at most {} are taken apart", mesh.triangles.size(),
                       kMostTrianglesToDivide);
  }
  std::vector<HACD::Vec3<HACD::Real>> points;
  std::vector<HACD::Vec3<long>> triangles;
  const Scaling scaling(mesh);
  for (const Vec3& p : mesh.points) {
    const Vec3 scaled = (p - scaling.middle) * scaling.factor;
    points.emplace_back(scaled.x(), scaled.y(), scaled.z());
  }
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  HACD::HACD hacd;
  hacd.SetPoints(points.data());
  hacd.SetNPoints(points.size());
  hacd.SetTriangles(triangles.data());
  hacd.SetNTriangles(triangles.size());
  hacd.SetCompacityWeight(0.1);
  hacd.SetVolumeWeight(0);
  hacd.SetNClusters(1);
  hacd.SetNVerticesPerCH(kMostPointsOfAPart);
  hacd.SetConcavity(kDeepestHollow);
  hacd.SetConnectDist(kFarthestPieces);
  // Hollows are measured there, too, not only at the points of the mesh.
  hacd.SetAddExtraDistPoints(true);
  hacd.SetAddNeighboursDistPoints(true);
  hacd.SetAddFacesPoints(true);
  if (!hacd.Compute()) return "it cannot be taken apart";
  if (hacd.GetNClusters() > kMostParts) {
    return fmt::format("it falls into {} convex parts, allowed: {}", hacd.GetNClusters(), kMostParts);
  }
  TriangleMesh pieces;
  for (std::size_t part = 0; part < hacd.GetNClusters(); ++part) {
    const TriangleMesh hull = part_of(hacd, part, scaling);
    if (is_sound(hull)) append(hull, pieces);
  }
  if (pieces.triangles.empty()) return "it encloses nothing";
  return pieces;
}

core::Compound convex_parts(const TriangleMesh& pieces) {
  std::vector<std::uint32_t> parent(pieces.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& t : pieces.triangles) {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  const Vec3 centre = centre_of_mass(pieces);
  std::map<std::uint32_t, TriangleMesh> part_of_root;
  for (std::uint32_t i = 0; i < pieces.points.size(); ++i) {
    part_of_root[root(i)].points.push_back(pieces.points[i] - centre);
  }
  core::Compound compound;
  for (const auto& [first, part] : part_of_root) {
    compound.parts.push_back({core::ConvexHull{hull_points(part)}, core::Pose{}});
  }
  return compound;
}

}  // namespace aurasim::config
