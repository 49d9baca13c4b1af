#include "physics/hull_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace aurasim::physics {
namespace {

/// The points of the last step are kept if they span this share of the area of others, and are as deep to within this
/// share of the margin. Otherwise piles would not come to rest: a new point begins without impulse.
constexpr double kKeptArea = 0.8, kKeptDepth = 1.0 / 8;

/// Corner of a polygon that is being clipped, in the frame of the hull whose face clips it.
struct ClipPoint {
  btVector3 p;
  std::int32_t of_face, of_clipped;  ///< features of the clipping hull and of the clipped one
  /// The side from here to the next corner: an edge of the clipped hull, or the number of a side of the clipping face.
  bool is_edge;
  std::uint32_t side;
};

/// Memory of one thread, kept between calls.
struct ClipSpace {
  std::vector<ClipPoint> polygon, clipped;
  std::vector<HullPoint> points;
};

ClipSpace& clip_space_of_this_thread() {
  thread_local ClipSpace space;
  return space;
}

/// A face of one hull that clips one of the other.
struct Clipping {
  const HullFaces& hull;
  std::uint32_t face;
  const HullFaces& other;
  std::uint32_t other_face;
  btTransform X;  ///< pose of the other hull in the frame of the first

  std::uint32_t begin() const { return hull.face_begin[face]; }
  std::uint32_t sides() const { return hull.face_begin[face + 1] - begin(); }
  std::uint32_t corner(std::uint32_t side) const { return hull.loop_corners[begin() + side % sides()]; }
  std::uint32_t edge(std::uint32_t side) const { return hull.loop_edges[begin() + side]; }
};

void begin_polygon(const Clipping& c, std::vector<ClipPoint>& polygon) {
  polygon.clear();
  for (std::uint32_t i = c.other.face_begin[c.other_face]; i < c.other.face_begin[c.other_face + 1]; ++i) {
    const std::uint32_t corner = c.other.loop_corners[i];
    polygon.push_back(
        {c.X(c.other.corners[corner]), face_feature(c.face), corner_feature(corner), true, c.other.loop_edges[i]});
  }
}

/// The corner where the side of `from` meets side `side` of the clipping face.
ClipPoint crossing(const Clipping& c, const ClipPoint& from, std::uint32_t side, const btVector3& p) {
  if (from.is_edge) return {p, edge_feature(c.edge(side)), edge_feature(from.side), true, from.side};
  const std::uint32_t later = (from.side + 1) % c.sides() == side ? side : from.side;
  return {p, corner_feature(c.corner(later)), face_feature(c.other_face), false, from.side};
}

/// Sutherland and Hodgman, Reentrant Polygon Clipping (1974), for one side of the face.
void clip(const Clipping& c, std::uint32_t side, const std::vector<ClipPoint>& polygon, std::vector<ClipPoint>& to) {
  const btVector3 start = c.hull.corners[c.corner(side)];
  const btVector3 out = (c.hull.corners[c.corner(side + 1)] - start).cross(c.hull.normals[c.face]);
  to.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClipPoint &from = polygon[i], &next = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const btScalar beyond = out.dot(from.p - start), next_beyond = out.dot(next.p - start);
    const auto cut = [&] { return from.p + (next.p - from.p) * (beyond / (beyond - next_beyond)); };
    if (beyond <= 0) {
      to.push_back(from);
      if (!(next_beyond > 0)) continue;
      ClipPoint leaves = crossing(c, from, side, cut());
      leaves.is_edge = false, leaves.side = side;
      to.push_back(leaves);
    } else if (next_beyond <= 0) {
      to.push_back(crossing(c, from, side, cut()));
    }
  }
}

/// The point of the clipping face that is nearest to p.
btVector3 nearest_on_face(const Clipping& c, const btVector3& p) {
  const btVector3 normal = c.hull.normals[c.face];
  const btVector3 in_plane = p - normal * (normal.dot(p) - c.hull.offsets[c.face]);
  btVector3 nearest = in_plane;
  bool is_outside = false;
  btScalar least = std::numeric_limits<btScalar>::infinity();
  for (std::uint32_t side = 0; side < c.sides(); ++side) {
    const btVector3 start = c.hull.corners[c.corner(side)], along = c.hull.corners[c.corner(side + 1)] - start;
    if (!(along.cross(normal).dot(in_plane - start) > 0)) continue;
    is_outside = true;
    const btScalar share = std::clamp(along.dot(in_plane - start) / along.length2(), btScalar(0), btScalar(1));
    const btVector3 on_side = start + along * share;
    if (on_side.distance2(in_plane) < least) least = on_side.distance2(in_plane), nearest = on_side;
  }
  return is_outside ? nearest : in_plane;
}

/// Are two points, of bodies that do not overlap, too far from each other for a contact?
bool is_far(const btVector3& on_a, const btVector3& on_b, double gap, double margin_m) {
  return gap > 0 && !(on_a.distance2(on_b) <= margin_m * margin_m);
}

/// A face and a face of the other hull, as points in the frame of the first: `on_a` on the first, `on_b` on the other.
void clip_faces(const Clipping& c, double margin_m, std::vector<HullPoint>& points) {
  ClipSpace& space = clip_space_of_this_thread();
  begin_polygon(c, space.polygon);
  for (std::uint32_t side = 0; side < c.sides(); ++side) {
    clip(c, side, space.polygon, space.clipped);
    space.polygon.swap(space.clipped);
  }
  const btVector3 normal = c.hull.normals[c.face];
  for (const ClipPoint& point : space.polygon) {
    const double gap = normal.dot(point.p) - c.hull.offsets[c.face];
    if (gap <= margin_m) points.push_back({point.p - normal * gap, point.p, gap, {point.of_face, point.of_clipped}});
  }
  if (!points.empty()) return;
  // The faces do not lie over each other: the bodies are apart, and perhaps near at a corner.
  const auto corner = static_cast<std::uint32_t>(c.other.corners.farthest(-(normal * c.X.getBasis())));
  const btVector3 on_other = c.X(c.other.corners[corner]), on_face = nearest_on_face(c, on_other);
  const double gap = normal.dot(on_other - on_face);
  if (is_far(on_face, on_other, gap, margin_m)) return;
  points.push_back({on_face, on_other, gap, {face_feature(c.face), corner_feature(corner)}});
}

/// The nearest points of two edges that are not parallel.
void cross_edges(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, const HullGap& closest,
                 double margin_m, std::vector<HullPoint>& points) {
  const HullFaces::Edge &of_a = a.edges[closest.axis.of_a], &of_b = b.edges[closest.axis.of_b];
  const btVector3 p = a.corners[of_a.from], u = a.along(of_a);
  const btVector3 q = X_AB(b.corners[of_b.from]), v = X_AB.getBasis() * b.along(of_b);
  const btScalar uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), up = u.dot(q - p), vp = v.dot(q - p);
  const btScalar share_a = std::clamp((up * vv - vp * uv) / (uu * vv - uv * uv), btScalar(0), btScalar(1));
  const btScalar share_b = std::clamp((share_a * uv - vp) / vv, btScalar(0), btScalar(1));
  HullPoint point{
      p + u * share_a, q + v * share_b, 0, {edge_feature(closest.axis.of_a), edge_feature(closest.axis.of_b)}};
  point.gap = closest.normal.dot(point.on_b - point.on_a);
  if (!is_far(point.on_a, point.on_b, point.gap, margin_m)) points.push_back(point);
}

using Chosen = std::array<const HullPoint*, 4>;

/// The point with the highest measure; the first one of several.
template <class Measure>
const HullPoint& best_of(std::span<const HullPoint> points, Measure&& measure) {
  const HullPoint* found = &points.front();
  double most = measure(*found);
  for (const HullPoint& q : points) {
    const double of_q = measure(q);
    if (of_q > most) most = of_q, found = &q;
  }
  return *found;
}

/// The deepest point, and those that span the largest area with it.
Chosen choose(std::span<const HullPoint> points, const btVector3& normal) {
  const HullPoint& deepest = best_of(points, [](const HullPoint& q) { return -q.gap; });
  const HullPoint& farthest = best_of(points, [&](const HullPoint& q) { return q.on_b.distance2(deepest.on_b); });
  const btVector3 across = (farthest.on_b - deepest.on_b).cross(normal);
  const auto aside = [&](const HullPoint& q) { return across.dot(q.on_b - deepest.on_b); };
  return {&deepest, &farthest, &best_of(points, aside),
          &best_of(points, [&](const HullPoint& q) { return -aside(q); })};
}

/// Twice the area that 4 points span, in whatever order they are.
double area_of(const Chosen& four) {
  const auto across = [&](int a, int b, int c, int d) {
    return (four[a]->on_b - four[b]->on_b).cross(four[c]->on_b - four[d]->on_b).length2();
  };
  return std::sqrt(std::max({across(0, 1, 2, 3), across(0, 2, 1, 3), across(0, 3, 1, 2)}));
}

double depth_of(const Chosen& four) {
  return -(*std::ranges::min_element(four, {}, [](const HullPoint* q) { return q->gap; }))->gap;
}

/// The points with these features, in their order; nothing if they are not 4, or one is missing.
std::optional<Chosen> same_as_before(std::span<const HullPoint> points, std::span<const ContactFeatures> before) {
  Chosen same{};
  if (before.size() != same.size()) return std::nullopt;
  for (std::size_t i = 0; i < same.size(); ++i) {
    const auto found = std::ranges::find(points, before[i], &HullPoint::features);
    if (found == points.end()) return std::nullopt;
    same[i] = &*found;
  }
  return same;
}

void reduce(std::span<const HullPoint> points, double margin_m, std::span<const ContactFeatures> before,
            HullPoints& to) {
  Chosen chosen = choose(points, to.normal);
  const std::optional<Chosen> same = same_as_before(points, before);
  if (same && area_of(*same) >= kKeptArea * area_of(chosen) &&
      depth_of(*same) >= depth_of(chosen) - kKeptDepth * margin_m) {
    chosen = *same;
  }
  for (const HullPoint* point : chosen) {
    const auto end = to.points.begin() + to.count;
    const bool is_there =
        std::any_of(to.points.begin(), end, [&](const HullPoint& q) { return q.features == point->features; });
    if (!is_there) to.points[static_cast<std::size_t>(to.count++)] = *point;
  }
}

}  // namespace

HullPoints contact_points(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, const HullGap& closest,
                          double margin_m, std::span<const ContactFeatures> before) {
  HullPoints result;
  result.normal = closest.normal;
  std::vector<HullPoint>& points = clip_space_of_this_thread().points;
  points.clear();
  if (closest.axis.kind == HullAxis::Kind::kEdges) {
    cross_edges(a, b, X_AB, closest, margin_m, points);
  } else if (closest.axis.kind == HullAxis::Kind::kFaceOfA) {
    clip_faces({a, closest.axis.of_a, b, opposite_face(b, closest.normal * X_AB.getBasis()), X_AB}, margin_m, points);
  } else {
    clip_faces({b, closest.axis.of_b, a, opposite_face(a, -closest.normal), X_AB.inverse()}, margin_m, points);
    for (HullPoint& point : points) {
      std::swap(point.on_a, point.on_b), std::swap(point.features.of_a, point.features.of_b);
      point.on_a = X_AB(point.on_a), point.on_b = X_AB(point.on_b);
    }
  }
  choose_points(points, margin_m, before, result);
  return result;
}

void choose_points(std::span<const HullPoint> points, double margin_m, std::span<const ContactFeatures> before,
                   HullPoints& to) {
  if (points.size() > to.points.size()) {
    reduce(points, margin_m, before, to);
  } else {
    for (const HullPoint& point : points) to.points[static_cast<std::size_t>(to.count++)] = point;
  }
}

std::uint32_t opposite_face(const HullFaces& hull, const btVector3& normal) {
  const std::size_t corner = hull.corners.farthest(-normal);
  std::uint32_t best = hull.corner_faces[hull.corner_begin[corner]];
  for (std::uint32_t i = hull.corner_begin[corner]; i < hull.corner_begin[corner + 1]; ++i) {
    const std::uint32_t face = hull.corner_faces[i];
    if (normal.dot(hull.normals[face]) < normal.dot(hull.normals[best])) best = face;
  }
  return best;
}

}  // namespace aurasim::physics
