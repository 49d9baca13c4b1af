// Between Bullet's vectors and those of the soft step.
#pragma once

#include <LinearMath/btVector3.h>

#include "physics/soft/lanes.h"

namespace aurasim::physics::soft {

inline btVector3 to_bullet(const Real (&v)[3]) { return {v[0], v[1], v[2]}; }

inline void from_bullet(const btVector3& v, Real (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<Real>(v[i]);
}

}  // namespace aurasim::physics::soft
