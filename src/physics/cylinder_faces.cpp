#include "physics/cylinder_faces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace aurasim::physics {
namespace {

/// A face is preferred to a cap, and to a search, if its gap is as wide to within this share of the margin.
constexpr double kPreferFace = 1.0 / 40;
/// A searched normal whose product with that of a face is larger gives the points of that face.
constexpr btScalar kAlongFace = btScalar(0.999);
/// Sine of the angle by which the line of a barrel and an edge may differ to touch in two points.
constexpr btScalar kAlongEdge = btScalar(0.02);
/// A face whose normal has a smaller product with that of a contact does not take part in it.
constexpr btScalar kTakesPart = btScalar(0.5);
/// Name of a point at an edge or corner that was searched.
constexpr std::int32_t kSearched = 64;
/// Names of the ends of a barrel along an edge.
constexpr std::int32_t kLowEnd = 65, kHighEnd = 66;
/// A point is on an edge if it is at most so far from it.
constexpr btScalar kOnEdge_m = btScalar(2e-3);

/// Memory of one thread, kept between calls.
struct CylinderSpace {
  std::vector<HullPoint> points;
  std::vector<btVector3> corners;
  std::vector<std::int32_t> corner_names, side_names;
};

CylinderSpace& cylinder_space_of_this_thread() {
  thread_local CylinderSpace space;
  return space;
}

FlatOutline outline_of(const HullFaces& hull, std::uint32_t face, CylinderSpace& space) {
  space.corners.clear(), space.corner_names.clear(), space.side_names.clear();
  for (std::uint32_t i = hull.face_begin[face]; i < hull.face_begin[face + 1]; ++i) {
    space.corners.push_back(hull.corners[hull.loop_corners[i]]);
    space.corner_names.push_back(corner_feature(hull.loop_corners[i]));
    space.side_names.push_back(edge_feature(hull.loop_edges[i]));
  }
  return {hull.normals[face], hull.offsets[face], space.corners,
          face_feature(face), space.corner_names, space.side_names};
}

double least_gap(std::span<const HullPoint> points) {
  double least = std::numeric_limits<double>::infinity();
  for (const HullPoint& point : points) least = std::min(least, point.gap);
  return least;
}

/// Up to 4 of the points. `up`: their normal, from B to A.
HullPoints chosen(const std::vector<HullPoint>& points, const btVector3& up, double margin_m,
                  std::span<const ContactFeatures> before) {
  HullPoints result;
  result.normal = -up;
  choose_points(points, margin_m, before, result);
  return result;
}

/// The ends of the part of a barrel that lies along a side of the face. `found` is a point of that side.
void add_points_of_edge(const Cylinder& cylinder, const FlatOutline& face, const SearchedPoint& found,
                        std::vector<HullPoint>& points) {
  const btScalar along = found.normal.dot(cylinder.axis);
  if (btFabs(along) > kAlongEdge) return;
  const btVector3 aside = (found.normal - cylinder.axis * along).normalized();
  const btVector3 line = cylinder.centre - aside * cylinder.radius;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const btVector3 from = face.corners[i], side = face.corners[i + 1 < face.corners.size() ? i + 1 : 0] - from;
    const btVector3 direction = side.normalized();
    if (direction.cross(cylinder.axis).length2() > kAlongEdge * kAlongEdge) continue;
    if (direction.cross(found.on_other - from).length2() > kOnEdge_m * kOnEdge_m) continue;
    const btScalar one = cylinder.axis.dot(from - line), other = cylinder.axis.dot(from + side - line);
    const btScalar low = std::max(std::min(one, other), -cylinder.half_height);
    const btScalar high = std::min(std::max(one, other), cylinder.half_height);
    if (!(low < high)) continue;
    for (const btScalar t : {low, high}) {
      const btVector3 p = line + cylinder.axis * t, on_edge = from + direction * direction.dot(p - from);
      points.push_back(
          {p, on_edge, double{found.normal.dot(p - on_edge)}, {t == low ? kLowEnd : kHighEnd, face.side_names[i]}});
    }
    return;
  }
}

/// The contact at an edge or corner, along the normal that was searched.
HullPoints searched_contact(const Cylinder& cylinder, const FlatOutline& face, const SearchedPoint& found,
                            double margin_m, std::span<const ContactFeatures> before, std::vector<HullPoint>& points) {
  points.clear();
  if (face.normal.dot(found.normal) > kAlongFace) {
    cylinder_points(cylinder, face, found.normal, margin_m, points);
  } else {
    add_points_of_edge(cylinder, face, found, points);
  }
  if (least_gap(points) <= double{found.gap} + kPreferFace * margin_m) {
    return chosen(points, found.normal, margin_m, before);
  }
  return single_point(found);
}

/// A normal, and the gap along it.
struct Axis {
  btVector3 up{0, 0, 0};
  double gap = -std::numeric_limits<double>::infinity();
  std::uint32_t face = 0;
};

Axis widest_face(const Cylinder& cylinder, const HullFaces& hull, double margin_m) {
  Axis best;
  for (std::uint32_t i = 0; i < hull.face_count(); ++i) {
    const btVector3 normal = hull.normals[i];
    const double gap = normal.dot(cylinder.centre) - cylinder.reach(normal) - hull.offsets[i];
    if (gap > best.gap) best = {normal, gap, i};
    if (gap > margin_m) break;
  }
  return best;
}

/// The cap that faces the hull, and the face of the hull below it.
Axis nearer_cap(const Cylinder& cylinder, const HullFaces& hull) {
  const bool upper = cylinder.axis.dot(hull.centre - cylinder.centre) > 0;
  const btVector3 up = upper ? -cylinder.axis : cylinder.axis;
  return {up, up.dot(cylinder.cap(upper)) - hull.corners.reach(up)[1], 0};
}

}  // namespace

HullPoints single_point(const SearchedPoint& found) {
  HullPoints result;
  result.normal = -found.normal;
  result.count = 1;
  result.points[0] = {found.on_other + found.normal * found.gap, found.on_other, double{found.gap}, {kSearched, 0}};
  return result;
}

HullPoints cylinder_contact(const Cylinder& cylinder, const HullFaces& hull, double margin_m,
                            std::span<const ContactFeatures> before, const NearestPoints& search) {
  CylinderSpace& space = cylinder_space_of_this_thread();
  Axis best = widest_face(cylinder, hull, margin_m);
  if (!(best.gap <= margin_m)) return {};
  const Axis cap = nearer_cap(cylinder, hull);
  if (!(cap.gap <= margin_m)) return {};
  if (cap.gap > best.gap + kPreferFace * margin_m) best = {cap.up, cap.gap, opposite_face(hull, -cap.up)};
  const FlatOutline face = outline_of(hull, best.face, space);
  if (face.normal.dot(best.up) > kTakesPart) {
    cylinder_points(cylinder, face, best.up, margin_m, space.points);
    if (least_gap(space.points) <= best.gap + kPreferFace * margin_m) {
      return chosen(space.points, best.up, margin_m, before);
    }
  }
  const std::optional<SearchedPoint> found = search.find();
  if (!found) return {};
  return searched_contact(cylinder, outline_of(hull, opposite_face(hull, -found->normal), space), *found, margin_m,
                          before, space.points);
}

HullPoints cylinder_contact(const Cylinder& cylinder, const HalfSpace& plane, double margin_m) {
  std::vector<HullPoint>& points = cylinder_space_of_this_thread().points;
  const FlatOutline face{plane.normal, plane.offset_m, {}, 0, {}, {}};
  cylinder_points(cylinder, face, plane.normal, margin_m, points);
  return chosen(points, plane.normal, margin_m, {});
}

HullPoints cylinder_contact(const Cylinder& cylinder, const btVector3 (&corners)[3], double margin_m,
                            const NearestPoints& search) {
  constexpr std::array<std::int32_t, 3> kCorners = {0, 1, 2}, kSides = {3, 4, 5};
  btVector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(normal.length2() > 0)) return {};
  normal.normalize();
  std::array<btVector3, 3> turned = {corners[0], corners[1], corners[2]};
  if (normal.dot(cylinder.centre - corners[0]) < 0) normal = -normal, std::swap(turned[1], turned[2]);
  const btScalar offset = normal.dot(corners[0]);
  const double gap = normal.dot(cylinder.centre) - cylinder.reach(normal) - offset;
  if (!(gap <= margin_m)) return {};
  std::vector<HullPoint>& points = cylinder_space_of_this_thread().points;
  const FlatOutline face{normal, offset, turned, 6, kCorners, kSides};
  cylinder_points(cylinder, face, normal, margin_m, points);
  if (least_gap(points) <= gap + kPreferFace * margin_m) return chosen(points, normal, margin_m, {});
  const std::optional<SearchedPoint> found = search.find();
  return found ? searched_contact(cylinder, face, *found, margin_m, {}, points) : HullPoints{};
}

}  // namespace aurasim::physics
