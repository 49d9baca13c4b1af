#include "config/convex_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
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
constexpr double kNormalSize = 1000;    ///< size of the scaled mesh from corner to corner, in HACD's units
constexpr double kDeepestHollow = 10;   ///< deepest hollow of a part that counts as convex, in HACD's units
constexpr double kFarthestPieces = 30;  ///< largest distance of pieces that may share a part, in HACD's units

/// Scales a mesh as HACD expects it: centred, and of a size that its limits are meant for.
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

/// For each point, the lowest point that it is connected with.
std::vector<std::uint32_t> pieces_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t other : {t[1], t[2]}) {
      const auto [low, high] = std::minmax({root(t[0]), root(other)});
      parent[high] = low;
    }
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = root(i);
  return parent;
}

/// Returns the mesh with the triangles of each piece facing out; files have them either way.
TriangleMesh facing_out(TriangleMesh mesh) {
  const std::vector<std::uint32_t> piece = pieces_of(mesh);
  std::map<std::uint32_t, double> volume;
  for (const auto& t : mesh.triangles) {
    const Vec3& origin = mesh.points[piece[t[0]]];
    const Vec3 a = mesh.points[t[0]] - origin, b = mesh.points[t[1]] - origin, c = mesh.points[t[2]] - origin;
    volume[piece[t[0]]] += a.dot(b.cross(c));
  }
  for (auto& t : mesh.triangles) {
    if (volume.at(piece[t[0]]) < 0) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// True when the mesh is closed, in one piece, and nowhere in front of one of its triangles by more than a hundred
/// thousandth of its size.
bool is_convex(const TriangleMesh& mesh, const Scaling& scaling) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) edges.emplace(t[i], t[(i + 1) % 3]);
  }
  const bool closed = std::ranges::all_of(edges, [&](const auto& e) { return edges.contains({e.second, e.first}); });
  if (!closed || std::ranges::any_of(pieces_of(mesh), [](std::uint32_t piece) { return piece != 0; })) return false;
  const double allowance = 1e-5 * kNormalSize / scaling.factor;
  return std::ranges::all_of(mesh.triangles, [&](const auto& t) {
    const Vec3& a = mesh.points[t[0]];
    const Vec3 normal = (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a);
    if (normal.norm() == 0) return true;
    const Vec3 n = normal.normalized();
    return std::ranges::all_of(mesh.points, [&](const Vec3& p) { return n.dot(p - a) <= allowance; });
  });
}

/// Makes the hull of a part from the few points that matter, because HACD's own hulls lose corners of small parts such
/// as tetrahedra. The points are first shaken by a millionth of their extent, so that no four lie in a plane and every
/// side is one triangle.
TriangleMesh hull_of(const TriangleMesh& part) {
  TriangleMesh hull;
  hull.points = hull_points(part);
  const Scaling scaling(hull);
  std::vector<Vec3> shaken;
  std::minstd_rand random(1);
  const auto shake = [&random] { return static_cast<double>(random()) / std::minstd_rand::max() - 0.5; };
  for (const Vec3& p : hull.points) {
    const double x = shake(), y = shake(), z = shake();
    shaken.push_back((p - scaling.middle) * scaling.factor + 1e-6 * kNormalSize * Vec3(x, y, z));
  }
  const auto count = static_cast<std::uint32_t>(shaken.size());
  const auto is_side = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Vec3 normal = (shaken[j] - shaken[i]).cross(shaken[k] - shaken[i]);
    return std::ranges::all_of(shaken, [&](const Vec3& p) {
      return &p == &shaken[i] || &p == &shaken[j] || &p == &shaken[k] || normal.dot(p - shaken[i]) < 0;
    });
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t j = i + 1; j < count; ++j) {
      for (std::uint32_t k = j + 1; k < count; ++k) {
        if (is_side(i, j, k)) hull.triangles.push_back({i, j, k});
        if (is_side(i, k, j)) hull.triangles.push_back({i, k, j});
      }
    }
  }
  return hull;
}

/// Returns the triangles that HACD has put into one part.
TriangleMesh triangles_of(const TriangleMesh& mesh, const HACD::HACD& hacd, std::size_t part) {
  TriangleMesh found;
  std::map<std::uint32_t, std::uint32_t> place;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (hacd.GetPartition()[t] != static_cast<long>(part)) continue;
    for (const std::uint32_t point : mesh.triangles[t]) {
      if (place.try_emplace(point, static_cast<std::uint32_t>(found.points.size())).second) {
        found.points.push_back(mesh.points[point]);
      }
    }
  }
  return found;
}

/// True when all points of `part` lie behind the triangles of `hull`, a convex mesh that faces out, up to a hundredth
/// of the whole mesh's size.
bool covers(const TriangleMesh& hull, const TriangleMesh& part, const Scaling& scaling) {
  const double allowance = 0.01 * kNormalSize / scaling.factor;
  return std::ranges::all_of(hull.triangles, [&](const auto& t) {
    const Vec3& a = hull.points[t[0]];
    const Vec3 normal = (hull.points[t[1]] - a).cross(hull.points[t[2]] - a);
    if (normal.norm() == 0) return true;
    const Vec3 n = normal.normalized();
    return std::ranges::all_of(part.points, [&](const Vec3& p) { return n.dot(p - a) <= allowance; });
  });
}

}  // namespace

std::variant<TriangleMesh, std::string> decompose(const TriangleMesh& as_it_came) {
  if (as_it_came.points.empty()) return "it has no points";
  if (as_it_came.triangles.size() > kMostTrianglesToDivide) {
    return fmt::format("it has {} triangles, at most {} are taken apart", as_it_came.triangles.size(),
                       kMostTrianglesToDivide);
  }
  const TriangleMesh mesh = facing_out(as_it_came);
  if (is_convex(mesh, Scaling(mesh))) return mesh;
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
  // Makes HACD measure hollows also between the points of the mesh.
  hacd.SetAddExtraDistPoints(true);
  hacd.SetAddNeighboursDistPoints(true);
  hacd.SetAddFacesPoints(true);
  if (!hacd.Compute()) return "it cannot be taken apart";
  if (hacd.GetNClusters() > kMostParts) {
    return fmt::format("it falls into {} convex parts, allowed: {}", hacd.GetNClusters(), kMostParts);
  }
  TriangleMesh pieces;
  for (std::size_t part = 0; part < hacd.GetNClusters(); ++part) {
    const TriangleMesh of_part = triangles_of(mesh, hacd, part);
    TriangleMesh hull = part_of(hacd, part, scaling);
    if (!is_sound(hull) || !covers(facing_out(hull), of_part, scaling)) hull = hull_of(of_part);
    if (is_sound(hull)) append(hull, pieces);
  }
  if (pieces.triangles.empty()) return "it encloses nothing";
  return pieces;
}

core::Compound convex_parts(const TriangleMesh& pieces) {
  const std::vector<std::uint32_t> piece = pieces_of(pieces);
  const Vec3 centre = centre_of_mass(pieces);
  std::map<std::uint32_t, TriangleMesh> part_of_root;
  for (std::uint32_t i = 0; i < pieces.points.size(); ++i) {
    part_of_root[piece[i]].points.push_back(pieces.points[i] - centre);
  }
  core::Compound compound;
  for (const auto& [first, part] : part_of_root) {
    compound.parts.push_back({core::ConvexHull{hull_points(part)}, core::Pose{}});
  }
  return compound;
}

}  // namespace aurasim::config
