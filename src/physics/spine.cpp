#include "physics/spine.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace aurasim::physics {
namespace {

using core::Vec3;

struct MakeSpine {
  Spine operator()(const core::Sphere& s) const { return {Vec3::Zero(), s.radius, true}; }
  Spine operator()(const core::Capsule& s) const { return {{0, 0, 0.5 * s.height}, s.radius, true}; }
  Spine operator()(const core::Cylinder& s) const { return {{0, 0, 0.5 * s.height}, s.radius, false}; }
  Spine operator()(const core::Box& s) const {
    int longest = 0;
    s.half_extents.maxCoeff(&longest);
    Vec3 across = s.half_extents;
    across[longest] = 0;
    return {s.half_extents[longest] * Vec3::Unit(longest), across.norm(), false};
  }
  Spine operator()(const core::ConvexHull& s) const {
    Vec3 reach = Vec3::Zero();
    for (const Vec3& point : s.points) reach = reach.cwiseMax(point.cwiseAbs());
    int longest = 0;
    reach.maxCoeff(&longest);
    double radius = 0;
    for (Vec3 point : s.points) {
      point[longest] = 0;
      radius = std::max(radius, point.norm());
    }
    return {reach[longest] * Vec3::Unit(longest), radius, false};
  }
};

double within_segment(double share) { return std::clamp(share, -1.0, 1.0); }

}  // namespace

Spine spine_of(const core::ConvexShape& shape) { return std::visit(MakeSpine{}, shape); }

/// Ericson, Real-Time Collision Detection (2005), section 5.1.9, with segments from -1 to 1.
double segments_apart(const Vec3& half_a, const Vec3& p_AB, const Vec3& half_b) {
  constexpr double kPoint = 1e-18;  // m^2
  const double aa = half_a.squaredNorm(), bb = half_b.squaredNorm();
  const double a_ahead = half_a.dot(p_AB), b_ahead = half_b.dot(p_AB);
  double s = 0, t = 0;
  if (aa > kPoint && bb > kPoint) {
    const double ab = half_a.dot(half_b);
    const double denominator = aa * bb - ab * ab;
    if (denominator > 0) s = within_segment((a_ahead * bb - ab * b_ahead) / denominator);
    t = (ab * s - b_ahead) / bb;
    if (std::abs(t) > 1) {
      t = within_segment(t);
      s = within_segment((ab * t + a_ahead) / aa);
    }
  } else if (aa > kPoint) {
    s = within_segment(a_ahead / aa);
  } else if (bb > kPoint) {
    t = within_segment(-b_ahead / bb);
  }
  return (p_AB + t * half_b - s * half_a).norm();
}

/// The squared distance from the box is convex along the segment, and a parabola between the planes of the faces.
double segment_from_box(const Vec3& p, const Vec3& half, const Vec3& half_extents) {
  const auto outside = [&](double t) -> Vec3 {
    const Vec3 at = p + t * half;
    return at - at.cwiseMax(-half_extents).cwiseMin(half_extents);
  };
  const auto slope = [&](double t) { return outside(t).dot(half); };
  if (slope(-1) >= 0) return outside(-1).norm();
  if (slope(1) <= 0) return outside(1).norm();
  double low = -1, high = 1;  // the slope is 0 in between
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-half_extents[axis], half_extents[axis]}) {
      const double t = (side - p[axis]) / half[axis];
      if (!(t > low && t < high)) continue;  // also if the segment is parallel to the face
      (slope(t) >= 0 ? high : low) = t;
    }
  }
  const double at_low = slope(low), at_high = slope(high);
  return outside(low + (high - low) * (at_low < 0 ? at_low / (at_low - at_high) : 0)).norm();
}

}  // namespace aurasim::physics
