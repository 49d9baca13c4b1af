#include "physics/two_cylinders.h"

#include <algorithm>
#include <array>
#include <limits>

#include "physics/rod_points.h"

namespace aurasim::physics {
namespace {

/// Caps whose axes have a larger product lie on each other. Both then look like discs, to within 0.2% of the radius.
constexpr btScalar kCapsLie = btScalar(0.998);
/// Normals with a smaller product with an axis are those of a barrel.
constexpr btScalar kOnBarrel = btScalar(0.02);
/// A searched normal whose product with an axis is larger is that of a cap.
constexpr btScalar kAlongCap = btScalar(0.999);
/// The deepest point may be so much less deep than a cap, as a share of the margin.
constexpr btScalar kAsDeep = btScalar(1) / 40;
/// Where the heights of a cap differ by less than this share of the margin, its points are at fixed places.
constexpr btScalar kCapLevel = btScalar(1) / 40;
/// Names of points: four around the cap, four if it leans, and the points of two barrels by their ends.
constexpr std::int32_t kAround = 1, kLeaning = 9, kBarrel = 17;

/// Two caps as discs, seen along `up`.
struct TwoDiscs {
  const Cylinder &a, &b;
  const btVector3& up;
  btVector3 cap_a, cap_b;

  btVector3 across(const btVector3& v) const { return v - up * up.dot(v); }
  /// How far p is outside of a disc, m.
  btScalar outside(const btVector3& p, const btVector3& centre, btScalar radius) const {
    return across(p - centre).length() - radius;
  }
  btScalar gap(const btVector3& p) const { return height(p, cap_a, a.axis) - height(p, cap_b, b.axis); }
  /// Height of a cap at the place of p.
  btScalar height(const btVector3& p, const btVector3& cap, const btVector3& axis) const {
    return up.dot(p) + axis.dot(cap - p) / axis.dot(up);
  }

  /// The place farthest along `direction` that is in both discs, on the plane through the centre of B's cap. Nothing
  /// if they do not lie over each other.
  std::optional<btVector3> farthest(const btVector3& direction) const {
    const btVector3 from = cap_b, to = across(cap_a - cap_b) + from;
    const btScalar distance = (to - from).length();
    if (!(distance < a.radius + b.radius)) return std::nullopt;
    const btVector3 of_a = to + direction * a.radius, of_b = from + direction * b.radius;
    if (outside(of_a, from, b.radius) <= 0) return of_a;
    if (outside(of_b, to, a.radius) <= 0) return of_b;
    // where the two rims cross
    const btVector3 way = (to - from) / distance, aside = up.cross(way);
    const btScalar along = (distance * distance + b.radius * b.radius - a.radius * a.radius) / (2 * distance);
    const btScalar half = btSqrt(std::max(btScalar(0), b.radius * b.radius - along * along));
    return from + way * along + aside * (aside.dot(direction) < 0 ? -half : half);
  }
};

/// The points of two caps along `up`, which points from B to A; none if the caps do not lie over each other.
HullPoints cap_points(const Cylinder& a, const Cylinder& b, const btVector3& up, double margin_m) {
  const bool lower_a = up.dot(a.axis) > 0, upper_b = up.dot(b.axis) > 0;
  const TwoDiscs discs{a, b, up, a.cap(!lower_a), b.cap(upper_b)};
  HullPoints result;
  result.normal = -up;
  const btVector3 lean = discs.across((lower_a ? a.axis : -a.axis) - (upper_b ? b.axis : -b.axis));
  const bool is_level = lean.length() * std::min(a.radius, b.radius) <= kCapLevel * static_cast<btScalar>(margin_m);
  const btVector3 first = (is_level ? discs.across(a.first) : lean).normalized(), second = up.cross(first);
  const std::int32_t begin = (is_level ? kAround : kLeaning) + (lower_a ? 0 : 4);
  std::int32_t number = 0;
  for (const btVector3& direction : {first, second, -first, -second}) {
    const std::optional<btVector3> place = discs.farthest(direction);
    if (!place) return result;
    const btScalar gap = discs.gap(*place);
    const std::int32_t name = begin + number++;
    if (!(gap <= static_cast<btScalar>(margin_m))) continue;
    const btVector3 on_b = *place + up * (discs.height(*place, discs.cap_b, b.axis) - up.dot(*place));
    result.points[static_cast<std::size_t>(result.count++)] = {on_b + up * gap, on_b, double{gap}, {name, upper_b}};
  }
  return result;
}

/// The normal of the cap of B that faces A, and the gap along it.
struct CapAxis {
  btVector3 up;
  btScalar gap;
};

CapAxis cap_axis(const Cylinder& a, const Cylinder& b) {
  const btScalar along = b.axis.dot(a.centre - b.centre);
  return {along < 0 ? -b.axis : b.axis, btFabs(along) - b.half_height - a.reach(b.axis)};
}

double least_gap_of(const HullPoints& found) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < found.count; ++i) least = std::min(least, found.points[static_cast<std::size_t>(i)].gap);
  return least;
}

std::optional<HullPoints> barrel_points(const Cylinder& a, const Cylinder& b, double margin_m) {
  const RodPoints found = rod_points({a.centre, a.axis * a.half_height, a.radius},
                                     Rod{b.centre, b.axis * b.half_height, b.radius}, margin_m);
  HullPoints result;
  const RodPoint* deepest = nullptr;
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    if (deepest == nullptr || found.points[i].gap < deepest->gap) deepest = &found.points[i];
  }
  if (deepest == nullptr) return HullPoints{};
  const auto is_on_barrel = [&](const btVector3& normal) {
    return btFabs(normal.dot(a.axis)) < kOnBarrel && btFabs(normal.dot(b.axis)) < kOnBarrel;
  };
  if (!is_on_barrel(deepest->normal)) return std::nullopt;
  result.normal = -deepest->normal;
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    const RodPoint& point = found.points[i];
    if (!is_on_barrel(point.normal)) continue;
    const btVector3 on_a = point.on_other + point.normal * point.gap;
    result.points[static_cast<std::size_t>(result.count++)] = {
        on_a, point.on_other, double{point.gap}, {kBarrel + point.features.of_a, kBarrel + point.features.of_b}};
  }
  return result;
}

}  // namespace

std::optional<HullPoints> cylinder_contact(const Cylinder& a, const Cylinder& b, double margin_m) {
  const CapAxis of_b = cap_axis(a, b), of_a = cap_axis(b, a);
  const btScalar margin = static_cast<btScalar>(margin_m);
  if (!(of_b.gap <= margin && of_a.gap <= margin)) return HullPoints{};
  if (btFabs(a.axis.dot(b.axis)) > kCapsLie) {
    const bool by_a = of_a.gap > of_b.gap + kAsDeep * margin;
    const btVector3 up = by_a ? -of_a.up : of_b.up;
    const HullPoints found = cap_points(a, b, up, margin_m);
    const btScalar gap = by_a ? of_a.gap : of_b.gap;
    const btScalar barrels = -(a.radius + b.radius);
    const bool is_cap = gap > barrels + (a.centre - b.centre - up * up.dot(a.centre - b.centre)).length();
    if (is_cap && least_gap_of(found) <= double{gap + kAsDeep * margin}) return found;
  }
  return barrel_points(a, b, margin_m);
}

HullPoints searched_contact(const Cylinder& a, const Cylinder& b, const SearchedPoint& found, double margin_m) {
  const btScalar along = std::max(btFabs(found.normal.dot(a.axis)), btFabs(found.normal.dot(b.axis)));
  if (along > kAlongCap && btFabs(a.axis.dot(b.axis)) > kCapsLie) {
    const HullPoints points = cap_points(a, b, found.normal, margin_m);
    if (least_gap_of(points) <= double{found.gap + kAsDeep * static_cast<btScalar>(margin_m)}) return points;
  }
  return single_point(found);
}

}  // namespace aurasim::physics
