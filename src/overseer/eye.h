// The viewpoint of a page and the size of its pixels. Changes that it cannot show need not be sent at once.
#pragma once

#include "core/body_state.h"

namespace aurasim::overseer {

struct Eye {
  core::Vec3 p_W = core::Vec3::Zero();
  core::Vec3 towards_W = core::Vec3::UnitX();  ///< length 1
  double half_angle_rad = 0;                   ///< half the opening of a cone around all that the picture shows
  double pixel_rad = 0;                        ///< angle that one pixel spans
};

/// Error with which a body may be drawn, metres: half a pixel within the picture, more outside of it.
double unseen_error_m(const Eye& eye, const core::Vec3& p_W);

}  // namespace aurasim::overseer
