// A joint as six axes, which is how the soft step sees it, of whatever kind it is.
#pragma once

#include <array>
#include <optional>

#include "physics/joint_frames.h"

class btRigidBody;

namespace aurasim::physics {

/// J of a as seen from J of b: three translations along the axes of b's, then the angles of turns about x, y and z, in
/// this order, each about the axes as they lie by then. Free where nothing is said.
struct JointAxes {
  struct Axis {
    bool is_held = false;  ///< between these, m or rad
    double low = 0, high = 0;
    double stiffness = 0, damping = 0, rest = 0;  ///< as core::SpringAxis
  };

  core::JointFrame frames;
  bool b_is_first = false;  ///< in Bullet's constraint
  std::array<Axis, 6> axes;
  bool has_motor = false;    ///< about z, unless there is a drive
  double motor_rad_s = 0;    ///< of a
  double motor_impulse = 0;  ///< N m s in a substep, at most
  double break_impulse = 0;  ///< N s or N m s in a substep
  double ball_damping = 0;   ///< as core::BallJoint

  // Of hinges and sliders:
  std::optional<std::size_t> own;  ///< the axis that they leave: 2 or 5
  core::JointResistance resistance;
  std::optional<core::JointDrive> drive;
  double position = 0;       ///< as the bodies are, rad or m, with all its turns
  double turns_rad = 0;      ///< what of them the angle of the six axes leaves out
  double drive_impulse = 0;  ///< of drive or motor in the last substep

  /// What its drive strives for besides, of a joint that follows another: rad or m as a step begins, and rad/s or m/s.
  double lead = 0, lead_speed = 0;
  bool lost_its_leader = false;  ///< then the drive rests

  /// Whether its drive pushes at all.
  bool is_driven() const;
  /// Whether it matters how often a hinge has turned.
  bool counts_turns() const;
};

/// Impulses as in make_constraint().
JointAxes axes_of(const core::JointSpec& joint, const core::JointFrame& frames, double substep_s);

/// A spring with a damper in a substep, solved implicitly: its impulse is stiffness (position - q) + steady - give
/// dq/dt, q as the substep begins and dq/dt as it ends; at most `most` either way.
struct ImplicitPull {
  double position = 0;   ///< rad or m, in the first substep of a step
  double drift = 0;      ///< rad or m: so much more in each after it
  double stiffness = 0;  ///< N m s/rad or N s/m
  double steady = 0;     ///< N m s or N s
  double give = 0;       ///< N m s^2/rad or N s^2/m
  double most = 0;       ///< N m s or N s
};
/// Of its drive, which it has.
ImplicitPull drive_pull_of(const JointAxes& joint, double substep_s);
ImplicitPull pull_of(const core::JointResistance& resistance, double substep_s);

/// How a hinge or slider of a constraint between these bodies stands and moves; of a hinge the angle is within half a
/// turn. Without its effort.
core::JointMotion measure(const JointAxes& joint, const btRigidBody& a, const btRigidBody& b);

}  // namespace aurasim::physics
