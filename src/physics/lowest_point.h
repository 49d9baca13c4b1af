// The point of a convex body that is lowest above a face.
#pragma once

#include <LinearMath/btTransform.h>

class btCollisionShape;

namespace aurasim::physics {

/// A shape at its pose.
struct PlacedShape {
  const btCollisionShape& shape;
  const btTransform& pose;
};

/// A point of the body's surface, in the world, that is lowest along `up` or nearly so. Of several it is that on the
/// side of `contact`, a point of the surface whose normal is -`normal`.
btVector3 lowest_point(const PlacedShape& body, const btVector3& up, const btVector3& contact, const btVector3& normal);

}  // namespace aurasim::physics
