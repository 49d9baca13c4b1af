// Contact points of rods (rod_points.h) with a plane, in closed form.
#pragma once

#include <array>
#include <cstdint>

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include "physics/rod_points.h"

class btCollisionShape;

namespace aurasim::physics {

/// The half-space where normal . x <= offset_m. `normal` has length 1.
struct HalfSpace {
  btVector3 normal{0, 0, 1};
  btScalar offset_m = 0;

  btScalar above(const btVector3& p) const { return normal.dot(p) - offset_m; }
};

/// The half-space below a plane's shape, in the world.
HalfSpace half_space_of(const btCollisionShape& plane, const btTransform& pose);

struct PlanePoint {
  btVector3 on_plane{0, 0, 0};
  btScalar gap = 0;          ///< along the plane's normal, m; negative: overlap
  std::int32_t feature = 0;  ///< end of the rod; 0: a ball
};

struct PlanePoints {
  int count = 0;
  std::array<PlanePoint, 2> points;
};

/// The ends of the rod with gaps of at most `margin_m`.
PlanePoints plane_points(const Rod& rod, const HalfSpace& plane, double margin_m);

}  // namespace aurasim::physics
