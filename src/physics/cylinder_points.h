// Contact points of a cylinder with a flat face, along a known normal: all points of a manifold at once, in closed
// form.
//
// A cylinder that stands touches with its cap: with points of the rim, with the places where the rim crosses the sides
// of the face, and with corners of the face below the cap. A cylinder that lies touches with the two ends of the line
// of its barrel that is over the face. Each point has its own exact gap, so there is no limit of an angle between
// points that touch and others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <LinearMath/btVector3.h>

#include "physics/hull_clip.h"

namespace aurasim::physics {

/// Metres. The directions have length 1 and are at right angles to each other.
struct Cylinder {
  btVector3 centre{0, 0, 0};
  btVector3 axis{0, 0, 1}, first{1, 0, 0}, second{0, 1, 0};
  btScalar half_height = 0, radius = 0;

  btVector3 cap(bool upper) const { return centre + axis * (upper ? half_height : -half_height); }
  /// Half the cylinder's extent along a direction of length 1.
  btScalar reach(const btVector3& direction) const;
};

/// A convex polygon, counter-clockwise seen from outside. Without corners: the whole plane.
struct FlatOutline {
  btVector3 normal{0, 0, 1};
  btScalar offset = 0;
  std::span<const btVector3> corners;
  /// Names of the face, of its corners, and of the sides that begin there (contact_features.h).
  std::int32_t face_name = 0;
  std::span<const std::int32_t> corner_names, side_names;

  /// Height of p above the plane of the face, measured along `up`.
  btScalar above(const btVector3& p, const btVector3& up) const { return (normal.dot(p) - offset) / normal.dot(up); }
};

/// Sets `found` to the points of the cylinder (A) with gaps of at most `margin_m` over the face (B). `up`: the normal
/// of the contact, of length 1, towards the cylinder; gaps are along it. Precondition: up . face.normal > 0.
void cylinder_points(const Cylinder& cylinder, const FlatOutline& face, const btVector3& up, double margin_m,
                     std::vector<HullPoint>& found);

}  // namespace aurasim::physics
