// A joint as six axes, which is how the soft step sees it, of whatever kind it is.
#pragma once

#include <array>

#include "physics/constraints.h"

namespace aurasim::physics {

/// J of a as seen from J of b: three translations along the axes of b's, then the angles of turns about x, y and z, in
/// this order, each about the axes as they lie by then. Free where nothing is said.
struct JointAxes {
  struct Axis {
    bool is_held = false;  ///< between these, m or rad
    double low = 0, high = 0;
    double stiffness = 0, damping = 0;  ///< as core::SpringAxis
  };

  JointFrames frames;
  bool b_is_first = false;  ///< in Bullet's constraint
  std::array<Axis, 6> axes;
  bool has_motor = false;    ///< about z
  double motor_rad_s = 0;    ///< of a
  double motor_impulse = 0;  ///< N m s in a substep, at most
  double break_impulse = 0;  ///< N s or N m s in a substep
};

/// Impulses as in make_constraint().
JointAxes axes_of(const core::JointSpec& joint, const JointFrames& frames, double substep_s);

}  // namespace aurasim::physics
