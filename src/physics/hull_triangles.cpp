#include "physics/hull_triangles.h"

#include <cmath>
#include <utility>

#include <LinearMath/btConvexHullComputer.h>

namespace aurasim::physics {
namespace {

using core::Vec3;

/// A hull with less volume than this share of its size cubed counts as flat: Bullet's result would be rounding errors.
constexpr double kFlat = 1e-9;

double size_of(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> hull_triangles(const std::vector<Vec3>& points) {
  if (points.size() < 4) return {};
  btConvexHullComputer hull;
  hull.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
  const auto original = [&](int vertex) { return static_cast<std::uint32_t>(hull.original_vertex_index[vertex]); };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double volume_m3 = 0;
  for (int face = 0; face < hull.faces.size(); ++face) {
    const btConvexHullComputer::Edge* const first = &hull.edges[hull.faces[face]];
    const int corner = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != corner;
         edge = edge->getNextEdgeOfFace()) {
      const auto& triangle = triangles.emplace_back(std::array<std::uint32_t, 3>{
          original(corner), original(edge->getSourceVertex()), original(edge->getTargetVertex())});
      const Vec3 a = points[triangle[0]] - points.front();
      volume_m3 += a.dot((points[triangle[1]] - points.front()).cross(points[triangle[2]] - points.front())) / 6;
    }
  }
  const double size_m = size_of(points);
  if (!(std::abs(volume_m3) > kFlat * size_m * size_m * size_m)) return {};
  if (volume_m3 < 0) {
    for (auto& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
  return triangles;
}

}  // namespace aurasim::physics
