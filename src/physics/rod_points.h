// Contact points of rods (balls and capsules: all points at most `radius` from a segment) with each other and with
// boxes, in closed form.
//
// The contact points of a rod are those of balls on its segment: of the ball where the two shapes are nearest, and of
// the balls at the ends of the part that lies along the other shape. Each has its own exact gap and normal. So a
// capsule that lies has two points, and one that stands or crosses another has one, with no limit of an angle between
// them.
#pragma once

#include <array>
#include <optional>

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include "physics/contact_features.h"

class btCollisionShape;

namespace aurasim::physics {

/// The segment from centre - half to centre + half, with a radius. `half` is 0 for a ball. Metres.
struct Rod {
  btVector3 centre{0, 0, 0}, half{0, 0, 0};
  btScalar radius = 0;

  btVector3 at(btScalar t) const { return centre + half * t; }
};

struct RodPoint {
  btVector3 normal{0, 0, 0};  ///< of length 1, from the other shape to the rod
  btVector3 on_other{0, 0, 0};
  btScalar gap = 0;  ///< m; negative: overlap
  /// `of_a`: the end of the rod, or 0 in between. `of_b`: the end of the other rod, or the side of the face at which
  /// the rod leaves a box, or 0.
  ContactFeatures features;
};

struct RodPoints {
  int count = 0;
  std::array<RodPoint, 3> points;
};

/// A ball or capsule in the world; nothing for other shapes.
std::optional<Rod> rod_of(const btCollisionShape& shape, const btTransform& pose);

/// The points where a rod is nearest to another one. The gap is exact, also of what is far apart.
RodPoint nearest_point(const Rod& rod, const Rod& other);

/// The point where a rod is nearest to a box about the origin. Nothing if the rod's segment is in the box.
std::optional<RodPoint> nearest_point(const Rod& rod, const btVector3& half_extents);

/// Points with gaps of at most `margin_m`. `other` is the other shape of RodPoint.
RodPoints rod_points(const Rod& rod, const Rod& other, double margin_m);

/// Points with gaps of at most `margin_m`, in the frame of a box about the origin. All components of `half_extents` are
/// positive.
RodPoints rod_points(const Rod& rod, const btVector3& half_extents, double margin_m);

}  // namespace aurasim::physics
