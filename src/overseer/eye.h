// From where and how sharply a page looks at the world: what it cannot see need not be told at once.
#pragma once

#include "core/body_state.h"

namespace aurasim::overseer {

struct Eye {
  core::Vec3 p_W = core::Vec3::Zero();
  core::Vec3 towards_W = core::Vec3::UnitX();  ///< length 1
  double half_angle_rad = 0;                   ///< of a cone around all that the picture shows
  double pixel_rad = 0;                        ///< what one pixel spans
};

/// So far from its place a body may be drawn: half a pixel within the picture, more outside of it. Metres.
double unseen_error_m(const Eye& eye, const core::Vec3& p_W);

}  // namespace aurasim::overseer
