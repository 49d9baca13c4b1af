#include "physics/hull_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "physics/bullet_convert.h"
#include "physics/hull_triangles.h"
#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
/// Corners of a polygon, counter-clockwise seen from outside.
using Loop = std::vector<std::uint32_t>;
using Directed = std::pair<std::uint32_t, std::uint32_t>;

/// Triangles whose corners lie within this share of the hull's size of a plane belong to one face.
constexpr double kFlatness = 1e-5;

constexpr std::size_t kNoGroup = std::numeric_limits<std::size_t>::max();

btVector3 area_of(const std::vector<btVector3>& points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

std::map<Directed, std::size_t> triangles_by_edge(const std::vector<Triangle>& triangles) {
  std::map<Directed, std::size_t> owners;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) owners[{triangles[i][k], triangles[i][(k + 1) % 3]}] = i;
  }
  return owners;
}

/// Gives each triangle the number of its face. Faces grow from the largest triangles, whose planes are the most exact.
std::vector<std::size_t> group_triangles(const std::vector<btVector3>& points, const std::vector<Triangle>& triangles,
                                         double tolerance_m) {
  const std::map<Directed, std::size_t> owners = triangles_by_edge(triangles);
  std::vector<std::size_t> order(triangles.size()), group(triangles.size(), kNoGroup);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{},
                           [&](std::size_t i) { return area_of(points, triangles[i]).length2(); });
  std::size_t groups = 0;
  for (const std::size_t seed : order) {
    if (group[seed] != kNoGroup) continue;
    const btVector3 area = area_of(points, triangles[seed]);
    const btVector3 normal = area.length2() > 0 ? area.normalized() : btVector3(0, 0, 0);
    const auto belongs = [&](std::size_t i) {
      return group[i] == kNoGroup && std::ranges::all_of(triangles[i], [&](std::uint32_t corner) {
               return std::abs(normal.dot(points[corner] - points[triangles[seed][0]])) <= tolerance_m;
             });
    };
    std::vector<std::size_t> open{seed};
    group[seed] = groups;
    while (!open.empty()) {
      const Triangle& t = triangles[open.back()];
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto next = owners.find({t[(k + 1) % 3], t[k]});
        if (next == owners.end() || !belongs(next->second)) continue;
        group[next->second] = groups;
        open.push_back(next->second);
      }
    }
    ++groups;
  }
  return group;
}

/// The outline of each group of triangles; nothing if a group has not exactly one.
std::optional<std::vector<Loop>> outlines(const std::vector<Triangle>& triangles,
                                          const std::vector<std::size_t>& group) {
  const std::map<Directed, std::size_t> owners = triangles_by_edge(triangles);
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(*std::ranges::max_element(group) + 1);
  for (const auto& [edge, owner] : owners) {
    const auto twin = owners.find({edge.second, edge.first});
    if (twin == owners.end()) return std::nullopt;
    if (group[twin->second] == group[owner]) continue;
    if (!next[group[owner]].emplace(edge.first, edge.second).second) return std::nullopt;
  }
  std::vector<Loop> loops;
  for (const auto& steps : next) {
    if (steps.size() < 3) return std::nullopt;
    Loop& loop = loops.emplace_back();
    std::uint32_t at = steps.begin()->first;
    do {
      loop.push_back(at);
      const auto step = steps.find(at);
      if (step == steps.end() || loop.size() > steps.size()) return std::nullopt;
      at = step->second;
    } while (at != loop.front());
    if (loop.size() != steps.size()) return std::nullopt;
  }
  return loops;
}

/// Twice the area of a polygon, along its normal.
btVector3 area_of(const std::vector<btVector3>& points, const Loop& loop) {
  btVector3 area(0, 0, 0);
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    area += (points[loop[i]] - points[loop[0]]).cross(points[loop[i + 1]] - points[loop[0]]);
  }
  return area;
}

/// Numbers the edges, and finds the faces at both sides of each. False if the loops do not close a surface.
bool add_edges(HullFaces& hull) {
  std::map<Directed, std::uint32_t> numbers;
  hull.loop_edges.assign(hull.loop_corners.size(), 0);
  for (std::uint32_t face = 0; face < hull.face_count(); ++face) {
    const std::uint32_t begin = hull.face_begin[face], end = hull.face_begin[face + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const Directed edge(hull.loop_corners[i], hull.loop_corners[i + 1 < end ? i + 1 : begin]);
      const auto twin = numbers.find({edge.second, edge.first});
      if (twin != numbers.end()) {
        hull.edges[twin->second].right = face;
        hull.loop_edges[i] = twin->second;
      } else {
        hull.loop_edges[i] = static_cast<std::uint32_t>(hull.edges.size());
        if (!numbers.emplace(edge, hull.loop_edges[i]).second) return false;
        hull.edges.push_back({edge.first, edge.second, face, face});
      }
    }
  }
  return std::ranges::none_of(hull.edges, [](const HullFaces::Edge& edge) { return edge.left == edge.right; }) &&
         hull.corners.size() + hull.face_count() == hull.edges.size() + 2;
}

void add_corner_faces(HullFaces& hull) {
  std::vector<std::vector<std::uint32_t>> at(hull.corners.size());
  for (std::uint32_t face = 0; face < hull.face_count(); ++face) {
    for (std::uint32_t i = hull.face_begin[face]; i < hull.face_begin[face + 1]; ++i) {
      at[hull.loop_corners[i]].push_back(face);
    }
  }
  for (const std::vector<std::uint32_t>& faces : at) {
    hull.corner_begin.push_back(static_cast<std::uint32_t>(hull.corner_faces.size()));
    hull.corner_faces.insert(hull.corner_faces.end(), faces.begin(), faces.end());
  }
  hull.corner_begin.push_back(static_cast<std::uint32_t>(hull.corner_faces.size()));
}

/// Finds a ball inside the hull. False if there is none.
bool add_balls(HullFaces& hull, const std::vector<btVector3>& corners) {
  for (const btVector3& corner : corners) hull.centre += corner / static_cast<double>(corners.size());
  hull.inner_radius = std::numeric_limits<double>::infinity();
  for (std::size_t face = 0; face < hull.face_count(); ++face) {
    hull.inner_radius = std::min(hull.inner_radius, hull.offsets[face] - hull.normals[face].dot(hull.centre));
  }
  for (const btVector3& corner : corners) hull.size = std::max(hull.size, (corner - hull.centre).length());
  return hull.inner_radius > 0 && std::isfinite(hull.size);
}

/// The polyhedron with these faces; null if they are not those of one with a volume.
std::unique_ptr<const HullFaces> polyhedron(const std::vector<btVector3>& points, const std::vector<Loop>& loops) {
  auto hull = std::make_unique<HullFaces>();
  std::map<std::uint32_t, std::uint32_t> numbers;
  std::vector<btVector3> corners, normals;
  for (const Loop& loop : loops) {
    for (const std::uint32_t point : loop) numbers.emplace(point, 0);
  }
  for (auto& [point, number] : numbers) {
    number = static_cast<std::uint32_t>(corners.size());
    corners.push_back(points[point]);
  }
  for (const Loop& loop : loops) {
    const btVector3 area = area_of(points, loop);
    if (!(area.length2() > 0)) return nullptr;
    const btVector3 normal = normals.emplace_back(area.normalized());
    double offset = -std::numeric_limits<double>::infinity();
    for (const btVector3& point : points) offset = std::max(offset, normal.dot(point));
    hull->offsets.push_back(offset);
    hull->face_begin.push_back(static_cast<std::uint32_t>(hull->loop_corners.size()));
    for (const std::uint32_t point : loop) hull->loop_corners.push_back(numbers.at(point));
  }
  hull->face_begin.push_back(static_cast<std::uint32_t>(hull->loop_corners.size()));
  hull->corners.assign(corners);
  hull->normals.assign(normals);
  if (!add_edges(*hull) || !add_balls(*hull, corners)) return nullptr;
  add_corner_faces(*hull);
  return hull;
}

}  // namespace

void PointLanes::assign(const std::vector<btVector3>& points) {
  size_ = points.size();
  const std::size_t padded = (size_ + soft::kPointsAtOnce - 1) / soft::kPointsAtOnce * soft::kPointsAtOnce;
  for (int k = 0; k < 3; ++k) {
    std::vector<double>& to = coordinates_[static_cast<std::size_t>(k)];
    to.clear();
    for (std::size_t i = 0; i < padded; ++i) to.push_back(points[i < size_ ? i : 0][k]);
  }
}

std::size_t PointLanes::farthest(const btVector3& direction) const {
  const double along[3] = {direction.x(), direction.y(), direction.z()};
  return soft::kernel().farthest_double(x(), y(), z(), padded_size(), along);
}

std::array<double, 2> PointLanes::reach(const btVector3& direction) const {
  const double along[3] = {direction.x(), direction.y(), direction.z()};
  double ends[2];
  soft::kernel().reach(x(), y(), z(), padded_size(), along, ends);
  return {ends[0], ends[1]};
}

std::unique_ptr<const HullFaces> hull_faces(const std::vector<core::Vec3>& points) {
  const std::vector<Triangle> triangles = hull_triangles(points);
  if (triangles.empty()) return nullptr;
  std::vector<btVector3> at;
  btVector3 low = to_bullet(points.front()), high = low;
  for (const core::Vec3& point : points) {
    at.push_back(to_bullet(point));
    low.setMin(at.back()), high.setMax(at.back());
  }
  const double tolerance_m = kFlatness * (high - low).length();
  if (const auto loops = outlines(triangles, group_triangles(at, triangles, tolerance_m))) {
    if (auto hull = polyhedron(at, *loops)) return hull;
  }
  std::vector<Loop> loops;
  for (const Triangle& t : triangles) loops.push_back({t.begin(), t.end()});
  return polyhedron(at, loops);
}

std::unique_ptr<const HullFaces> box_faces(const core::Vec3& half_extents) {
  std::vector<btVector3> points;
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back((corner & 1 ? 1 : -1) * half_extents.x(), (corner & 2 ? 1 : -1) * half_extents.y(),
                        (corner & 4 ? 1 : -1) * half_extents.z());
  }
  return polyhedron(points, {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}});
}

void set_hull_faces(btCollisionShape& shape, const HullFaces* faces) {
  shape.setUserPointer(const_cast<HullFaces*>(faces));  // only read, by hull_faces_of()
}

const HullFaces* hull_faces_of(const btCollisionShape& shape) {
  return shape.isPolyhedral() ? static_cast<const HullFaces*>(shape.getUserPointer()) : nullptr;
}

}  // namespace aurasim::physics
