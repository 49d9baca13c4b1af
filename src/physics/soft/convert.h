// Conversions between Bullet's vectors and those of the soft step, and into its lanes.
#pragma once

#include <LinearMath/btVector3.h>

#include "physics/soft/lanes.h"

namespace aurasim::physics::soft {

inline btVector3 to_bullet(const Real (&v)[3]) { return {v[0], v[1], v[2]}; }

inline void from_bullet(const btVector3& v, Real (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<Real>(v[i]);
}

/// Writes a symmetric matrix into one lane.
inline void set(Lanes (&to)[6], int lane, const Real (&m)[6]) {
  for (int i = 0; i < 6; ++i) to[i][lane] = m[i];
}

}  // namespace aurasim::physics::soft
