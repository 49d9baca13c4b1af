#include "physics/rod_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

namespace aurasim::physics {
namespace {

/// The nearest point is left out if a point at an end is as deep, to within this share of the margin.
constexpr btScalar kPrefer = btScalar(1) / 40;
/// Two points are one if they are nearer to each other than this share of the rod's radius.
constexpr btScalar kApart = btScalar(0.25);
/// Nearer to each other, m, two points count as one, so the line between them gives no normal.
constexpr btScalar kTouch_m = btScalar(1e-9);
/// Directions whose angle has a smaller sine squared count as parallel.
constexpr btScalar kParallel = btScalar(1e-10);
/// A share of the half length that is as near to 1 is the end.
constexpr btScalar kEnd = btScalar(1e-6);

/// 1 and 2 for the ends of a rod, 0 between them.
std::int32_t end_feature(btScalar t) { return t < kEnd - 1 ? 1 : t > 1 - kEnd ? 2 : 0; }

btScalar clamped(btScalar t) { return std::clamp(t, btScalar(-1), btScalar(1)); }

/// Some direction across `direction`, which may be 0.
btVector3 across(const btVector3& direction) {
  if (!(direction.length2() > 0)) return {0, 0, 1};
  btVector3 one, other;
  btPlaneSpace1(direction.normalized(), one, other);
  return one;
}

/// A part of the rod's segment, as shares of its half length.
struct Part {
  btScalar from = -1, to = 1;

  bool is_empty() const { return !(from < to); }
};

/// Puts together the points at the ends of `along` and the nearest one. `point_at(t)` is the point of the ball at t.
template <class PointAt>
RodPoints chosen(const Rod& rod, const RodPoint& nearest, btScalar t_nearest, const Part& along, btScalar margin_m,
                 const PointAt& point_at) {
  RodPoints result;
  const auto add = [&result](const RodPoint& point) {
    result.points[static_cast<std::size_t>(result.count++)] = point;
  };
  const btScalar length = rod.half.length(), apart = kApart * rod.radius;
  const auto is_apart = [&](btScalar one, btScalar other) { return btFabs(one - other) * length > apart; };
  if (!along.is_empty() && is_apart(along.from, along.to)) {
    const RodPoint first = point_at(along.from), last = point_at(along.to);
    const bool has_both = first.gap <= margin_m && last.gap <= margin_m;
    if (has_both && nearest.gap >= std::min(first.gap, last.gap) - kPrefer * margin_m) {
      add(first), add(last);
      return result;
    }
    const auto is_another = [&](const RodPoint& point, btScalar t) {
      return point.gap <= margin_m && point.features != nearest.features && is_apart(t, t_nearest);
    };
    if (is_another(first, along.from)) add(first);
    if (is_another(last, along.to)) add(last);
  }
  add(nearest);
  return result;
}

/// The shares of two half lengths at which two segments are nearest to each other.
struct Shares {
  btScalar of_rod, of_other;
};

/// Two segments, and the products of their half lengths.
struct TwoSegments {
  TwoSegments(const Rod& rod, const Rod& other)
      : uu(rod.half.dot(rod.half)),
        uv(rod.half.dot(other.half)),
        vv(other.half.dot(other.half)),
        uw(rod.half.dot(rod.centre - other.centre)),
        vw(other.half.dot(rod.centre - other.centre)) {}

  btScalar on_rod(btScalar of_other) const { return uu > 0 ? (uv * of_other - uw) / uu : 0; }
  btScalar on_other(btScalar of_rod) const { return vv > 0 ? (uv * of_rod + vw) / vv : 0; }

  /// The square of the distance is convex in both shares. Its least value for one share is known for each of the other,
  /// so what leaves the range of one share is clamped, and the other one follows.
  Shares nearest() const {
    const btScalar determinant = uu * vv - uv * uv;
    const btScalar free = determinant > kParallel * uu * vv ? (uv * vw - vv * uw) / determinant : on_rod(0);
    const btScalar of_other = clamped(on_other(clamped(free)));
    const btScalar of_rod = clamped(on_rod(of_other));
    return {of_rod, clamped(on_other(of_rod))};
  }

  /// The part of the rod that lies along the other one.
  Part along() const {
    if (!(uu > 0 && vv > 0)) return {0, 0};
    const btScalar first = first_end();
    return {std::max(btScalar(-1), on_rod(first)), std::min(btScalar(1), on_rod(-first))};
  }
  /// The shares at an end of along().
  Shares at(btScalar of_rod) const {
    for (const btScalar end : {-first_end(), first_end()}) {
      if (of_rod == on_rod(end)) return {of_rod, end};
    }
    return {of_rod, clamped(on_other(of_rod))};
  }

  /// The end of the other segment that is nearer to the rod's end at -1.
  btScalar first_end() const { return uv > 0 ? -1 : 1; }

  const btScalar uu, uv, vv;  ///< products of the half lengths
  const btScalar uw, vw;      ///< of each with the way from the other's centre to the rod's
};

RodPoint point_of_balls(const Rod& rod, const Rod& other, Shares at) {
  const btVector3 on_other = other.at(at.of_other), way = rod.at(at.of_rod) - on_other;
  const btScalar distance = way.length();
  btVector3 normal;
  if (distance > kTouch_m) {
    normal = way / distance;
  } else {
    normal = rod.half.cross(other.half);
    const btScalar length2 = normal.length2();
    const bool crosses = length2 > kParallel * rod.half.length2() * other.half.length2();
    normal =
        crosses ? normal / btSqrt(length2) : across(rod.half.length2() > other.half.length2() ? rod.half : other.half);
    if (normal.dot(rod.centre - other.centre) < 0) normal = -normal;
  }
  return {normal,
          on_other + normal * other.radius,
          distance - rod.radius - other.radius,
          {end_feature(at.of_rod), end_feature(at.of_other)}};
}

/// How far p is beyond the faces of a box along each axis; 0 where it lies between two.
btVector3 beyond(const btVector3& p, const btVector3& half_extents) {
  btVector3 result;
  for (int k = 0; k < 3; ++k) result[k] = p[k] - std::clamp(p[k], -half_extents[k], half_extents[k]);
  return result;
}

/// Half the derivative of the squared distance from the box at a share of the rod's half length. It does not decrease.
btScalar slope(const Rod& rod, const btVector3& half_extents, btScalar t) {
  return beyond(rod.at(t), half_extents).dot(rod.half);
}

/// The share of the rod's half length at which it is nearest to a box. The slope is linear between the places where the
/// segment crosses the planes of faces, so the least distance lies where it is 0 between two of them.
btScalar nearest_to_box(const Rod& rod, const btVector3& half_extents) {
  btScalar low = -1, high = 1;
  btScalar at_low = slope(rod, half_extents, low), at_high = slope(rod, half_extents, high);
  if (at_low >= 0) return low;
  if (at_high <= 0) return high;
  for (int k = 0; k < 3; ++k) {
    if (rod.half[k] == 0) continue;
    for (const btScalar side : {-half_extents[k], half_extents[k]}) {
      const btScalar t = (side - rod.centre[k]) / rod.half[k];
      if (!(t > low && t < high)) continue;
      const btScalar here = slope(rod, half_extents, t);
      if (here == 0) return t;
      if (here < 0) {
        low = t, at_low = here;
      } else {
        high = t, at_high = here;
      }
    }
  }
  return low + (high - low) * (at_low / (at_low - at_high));
}

/// A face of a box: +1 or -1 along an axis.
struct BoxFace {
  int axis;
  btScalar sign;

  btScalar above(const btVector3& p, const btVector3& half_extents) const {
    return sign * p[axis] - half_extents[axis];
  }
};

/// The part of a rod over a face, and the sides of the face at which it ends; 0 where the rod ends.
struct Over {
  Part part;
  std::int32_t side_from = 0, side_to = 0;
};

std::int32_t side_feature(int axis, bool positive) { return 1 + 2 * axis + (positive ? 1 : 0); }

Over over_face(const Rod& rod, const btVector3& half_extents, int face_axis) {
  Over over;
  for (int k = 0; k < 3; ++k) {
    if (k == face_axis) continue;
    if (rod.half[k] == 0) {
      if (btFabs(rod.centre[k]) > half_extents[k]) return {{1, -1}};
      continue;
    }
    const bool up = rod.half[k] > 0;
    const btScalar in = ((up ? -half_extents[k] : half_extents[k]) - rod.centre[k]) / rod.half[k];
    const btScalar out = ((up ? half_extents[k] : -half_extents[k]) - rod.centre[k]) / rod.half[k];
    if (in > over.part.from) over.part.from = in, over.side_from = side_feature(k, !up);
    if (out < over.part.to) over.part.to = out, over.side_to = side_feature(k, up);
  }
  return over;
}

/// Contacts of a rod with the surface of a box.
class OnBox {
 public:
  OnBox(const Rod& rod, const btVector3& half_extents, btScalar margin_m)
      : rod_(rod), half_extents_(half_extents), margin_(margin_m) {}

  RodPoints points() const {
    for (int k = 0; k < 3; ++k) {
      const btScalar apart = btFabs(rod_.centre[k]) - btFabs(rod_.half[k]) - half_extents_[k] - rod_.radius;
      if (apart > margin_) return {};
    }
    const btScalar t = nearest_to_box(rod_, half_extents_);
    const btVector3 way = beyond(rod_.at(t), half_extents_);
    const btScalar distance = way.length();
    if (!(distance - rod_.radius <= margin_)) return {};
    return distance > kTouch_m ? outside(t, way) : inside();
  }

  /// Nothing if the segment is in the box.
  std::optional<RodPoint> nearest() const {
    const btScalar t = nearest_to_box(rod_, half_extents_);
    if (!(beyond(rod_.at(t), half_extents_).length() > kTouch_m)) return std::nullopt;
    return ball_at(t, 0);
  }

 private:
  /// The segment is outside of the box. `way`: from the box to the segment at t, where it is nearest.
  RodPoints outside(btScalar t, const btVector3& way) const {
    const int axis = way.absolute().maxAxis();
    const Over over = over_face(rod_, half_extents_, axis);
    return chosen(rod_, ball_at(t, side_of(way, axis)), t, over.part, margin_,
                  [&](btScalar end) { return ball_at(end, end == over.part.from ? over.side_from : over.side_to); });
  }

  /// The side of a face beyond which a point is.
  static std::int32_t side_of(const btVector3& way, int face_axis) {
    btVector3 aside = way;
    aside[face_axis] = 0;
    const int k = aside.absolute().maxAxis();
    return aside[k] == 0 ? 0 : side_feature(k, aside[k] > 0);
  }

  /// Precondition: the segment is outside of the box at t.
  RodPoint ball_at(btScalar t, std::int32_t side) const {
    const btVector3 p = rod_.at(t), way = beyond(p, half_extents_);
    const btScalar distance = way.length();
    return {way / distance, p - way, distance - rod_.radius, named(t, side)};
  }

  static ContactFeatures named(btScalar t, std::int32_t side) {
    const std::int32_t end = end_feature(t);
    return {end, end == 0 ? side : 0};
  }

  /// The segment is in the box: the rod leaves it along the normal of a face, or across one of its edges, whichever is
  /// the shortest way.
  RodPoints inside() const {
    BoxFace face{0, 1};
    btScalar least = std::numeric_limits<btScalar>::infinity();
    for (int k = 0; k < 3; ++k) {
      const btScalar overlap = half_extents_[k] + btFabs(rod_.half[k]) - btFabs(rod_.centre[k]);
      if (overlap < least) least = overlap, face = {k, rod_.centre[k] < 0 ? btScalar(-1) : btScalar(1)};
    }
    if (const std::optional<RodPoint> crossing = across_edge(least - kPrefer * margin_)) return {1, {*crossing}};
    return through(face);
  }

  /// The point of the segment's overlap with an edge along the shortest way across both. Nothing if none is shorter
  /// than `least_m`.
  std::optional<RodPoint> across_edge(btScalar least_m) const {
    std::optional<RodPoint> found;
    for (int axis = 0; axis < 3; ++axis) {
      btVector3 edge(0, 0, 0);
      edge[axis] = half_extents_[axis];
      btVector3 normal = rod_.half.cross(edge);
      const btScalar length2 = normal.length2();
      if (!(length2 > kParallel * rod_.half.length2() * edge.length2())) continue;
      normal /= btSqrt(length2);
      if (normal.dot(rod_.centre) < 0) normal = -normal;
      const btScalar overlap = normal.absolute().dot(half_extents_) - normal.dot(rod_.centre);
      if (!(overlap < least_m)) continue;
      least_m = overlap;
      Rod side{btVector3(0, 0, 0), edge, 0};
      for (int k = 0; k < 3; ++k) {
        if (k != axis) side.centre[k] = normal[k] < 0 ? -half_extents_[k] : half_extents_[k];
      }
      const Shares at = TwoSegments(rod_, side).nearest();
      const auto place = static_cast<std::int32_t>(7 + axis);
      found = {normal, side.at(at.of_other), -overlap - rod_.radius, {end_feature(at.of_rod), place}};
    }
    return found;
  }

  RodPoints through(const BoxFace& face) const {
    const Over over = over_face(rod_, half_extents_, face.axis);
    const auto at = [&](btScalar t, std::int32_t side) {
      const btVector3 p = rod_.at(t);
      RodPoint point;
      point.normal[face.axis] = face.sign;
      const btScalar above = face.above(p, half_extents_);
      point.on_other = p - point.normal * above;
      point.gap = above - rod_.radius;
      point.features = named(t, side);
      return point;
    };
    const RodPoint first = at(over.part.from, over.side_from), last = at(over.part.to, over.side_to);
    const bool first_is_deeper = first.gap <= last.gap;
    return chosen(rod_, first_is_deeper ? first : last, first_is_deeper ? over.part.from : over.part.to, over.part,
                  margin_, [&](btScalar t) { return t == over.part.from ? first : last; });
  }

  const Rod& rod_;
  const btVector3& half_extents_;
  const btScalar margin_;
};

}  // namespace

std::optional<Rod> rod_of(const btCollisionShape& shape, const btTransform& pose) {
  if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
    return Rod{pose.getOrigin(), {0, 0, 0}, static_cast<const btSphereShape&>(shape).getRadius()};
  }
  if (shape.getShapeType() != CAPSULE_SHAPE_PROXYTYPE) return std::nullopt;
  const auto& capsule = static_cast<const btCapsuleShape&>(shape);
  return Rod{pose.getOrigin(), pose.getBasis().getColumn(capsule.getUpAxis()) * capsule.getHalfHeight(),
             capsule.getRadius()};
}

RodPoint nearest_point(const Rod& rod, const Rod& other) {
  return point_of_balls(rod, other, TwoSegments(rod, other).nearest());
}

std::optional<RodPoint> nearest_point(const Rod& rod, const btVector3& half_extents) {
  return OnBox(rod, half_extents, 0).nearest();
}

RodPoints rod_points(const Rod& rod, const Rod& other, double margin_m) {
  const TwoSegments two(rod, other);
  const auto margin = static_cast<btScalar>(margin_m);
  const Shares nearest = two.nearest();
  const RodPoint deepest = point_of_balls(rod, other, nearest);
  if (!(deepest.gap <= margin)) return {};
  return chosen(rod, deepest, nearest.of_rod, two.along(), margin,
                [&](btScalar of_rod) { return point_of_balls(rod, other, two.at(of_rod)); });
}

RodPoints rod_points(const Rod& rod, const btVector3& half_extents, double margin_m) {
  return OnBox(rod, half_extents, static_cast<btScalar>(margin_m)).points();
}

}  // namespace aurasim::physics
