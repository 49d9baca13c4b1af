// Any kind of joint described by six axes, as the soft step uses it.
#pragma once

#include <array>
#include <optional>

#include "physics/joint_frames.h"

class btRigidBody;

namespace aurasim::physics {

/// The pose of J of a relative to J of b: three translations along the axes of b's J, then turns about x, y and z in
/// this order, each about the axis as turned by then. An axis without settings is free.
struct JointAxes {
  struct Axis {
    bool is_held = false;  ///< held between low and high, m or rad
    double low = 0, high = 0;
    double stiffness = 0, damping = 0, rest = 0;  ///< see core::SpringAxis
  };

  core::JointFrame frames;
  bool b_is_first = false;  ///< b is the first body of Bullet's constraint
  std::array<Axis, 6> axes;
  bool has_motor = false;    ///< motor about z; inactive while there is a drive
  double motor_rad_s = 0;    ///< target speed of the motor, of a
  double motor_impulse = 0;  ///< N m s in a substep, at most
  double break_impulse = 0;  ///< N s or N m s in a substep
  double ball_damping = 0;   ///< see core::BallJoint::damping

  // The members from here on are used only for hinges and sliders.
  std::optional<std::size_t> own;  ///< the axis that the joint leaves free: 2 or 5
  core::JointResistance resistance;
  std::optional<core::JointDrive> drive;
  double position = 0;       ///< present position, rad or m, with whole turns
  double turns_rad = 0;      ///< whole turns, which the angle of the six axes leaves out
  double drive_impulse = 0;  ///< impulse of drive or motor in the last substep

  /// Coupling: what the leader adds to the drive's targets, position (rad or m, at the start of a step) and speed
  /// (rad/s or m/s).
  double lead = 0, lead_speed = 0;
  bool lost_its_leader = false;  ///< coupling: a joint of the way to the leader is gone, so the drive rests

  /// Does the drive act at all?
  bool is_driven() const;
  /// Does it matter how often the hinge has turned?
  bool counts_turns() const;
};

/// The axes of a joint. Impulses are scaled to `substep_s` as in make_constraint().
JointAxes axes_of(const core::JointSpec& joint, const core::JointFrame& frames, double substep_s);

/// A spring with a damper in a substep, solved implicitly. Its impulse is stiffness (position - q) + steady - give
/// dq/dt, with q at the start of the substep and dq/dt at its end; at most `most` either way.
struct ImplicitPull {
  double position = 0;   ///< rad or m, in the first substep of a step
  double drift = 0;      ///< rad or m that `position` grows in each later substep
  double stiffness = 0;  ///< N m s/rad or N s/m
  double steady = 0;     ///< N m s or N s
  double give = 0;       ///< N m s^2/rad or N s^2/m
  double most = 0;       ///< N m s or N s
};
/// The pull of the joint's drive in a substep. Precondition: the joint has a drive.
ImplicitPull drive_pull_of(const JointAxes& joint, double substep_s);
ImplicitPull pull_of(const core::JointResistance& resistance, double substep_s);

/// Position and speed of a hinge or slider between the constraint's bodies. A hinge's angle is within half a turn. The
/// effort is left 0.
core::JointMotion measure(const JointAxes& joint, const btRigidBody& a, const btRigidBody& b);

}  // namespace aurasim::physics
