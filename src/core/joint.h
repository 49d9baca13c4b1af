// Joints between bodies of a scene, as plain data. J is the joint's frame, given in the world at the bodies' initial
// poses; from then on it moves with each of the two bodies. "Of a" means: of body a relative to body b, or to the world
// if there is no b.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// Limits of a joint's coordinate, radians or metres, low <= high. For hinges and translations one of the two may be
/// infinite.
struct JointLimits {
  double low = 0;
  double high = 0;
};

struct JointMotor {
  double speed = 0;        ///< target speed of a: rad/s or m/s
  double max_impulse = 0;  ///< impulse in 1/240 s: N m s or N s
};

/// Drives a hinge or slider along its coordinate q: effort = stiffness (position - q) + damping (speed - dq/dt) +
/// effort, at most max_effort either way. Solved implicitly, so stiff drives are stable. Units: rad or m, N m/rad or
/// N/m, N m s/rad or N s/m, N m or N.
struct JointDrive {
  double position = 0;
  double speed = 0;
  double stiffness = 0;
  double damping = 0;
  double effort = 0;
  double max_effort = std::numeric_limits<double>::infinity();

  bool operator==(const JointDrive&) const = default;

  static constexpr std::size_t kNumbers = 6;
  /// The six values in the order of their declaration, as in messages and records.
  std::array<double, kNumbers> numbers() const { return {position, speed, stiffness, damping, effort, max_effort}; }
  static JointDrive of(std::span<const double, kNumbers> n) { return {n[0], n[1], n[2], n[3], n[4], n[5]}; }
};

/// Resistance of a hinge or slider itself, driven or not. Solved implicitly. Units as in JointDrive.
struct JointResistance {
  double stiffness = 0;  ///< towards `rest`
  double rest = 0;
  double damping = 0;
  double friction = 0;  ///< Coulomb friction, as an effort

  bool operator==(const JointResistance&) const = default;
};

/// Coordinate of a hinge or slider, of a from b, and its rate; 0 is the placement of the scene. Units: rad, rad/s, N m,
/// or m, m/s, N.
struct JointMotion {
  double position = 0;
  double speed = 0;
  double effort = 0;  ///< effort of its drive or motor in the last substep
};

/// Couples the drive of a hinge or slider to another joint of its mechanism, the leader. The drive's targets become its
/// own position plus `ratio` times the leader's position, and likewise for the speed. The leader feels no reaction.
/// While a joint between the two is broken, the drive rests. A new setpoint for the joint ends the coupling.
struct JointCoupling {
  JointId leader{};
  double ratio = 1;  ///< rad or m for each rad or m of the leader
};

/// Holds the origins of the two bodies' J frames together; rotation is free.
struct BallJoint {
  double damping = 0;  ///< N m s/rad
};

/// Turns about the z axis of J.
struct HingeJoint {
  std::optional<JointLimits> limits;  ///< limits of the angle, which counts on beyond half a turn
  std::optional<JointMotor> motor;
  JointResistance resistance = {};
  std::optional<JointDrive> drive = {};       ///< only without a motor
  std::optional<JointCoupling> follows = {};  ///< with a drive
};

/// Slides along the z axis of J and does not turn.
struct SliderJoint {
  std::optional<JointLimits> limits;
  JointResistance resistance = {};
  std::optional<JointDrive> drive = {};
  std::optional<JointCoupling> follows = {};  ///< with a drive
};

/// A joint that neither moves nor turns.
struct FixedJoint {};

/// One degree of freedom of a spring.
struct SpringAxis {
  std::optional<JointLimits> limits;  ///< free without; low = high locks it
  double stiffness = 0;               ///< N/m or N m/rad, towards `rest`
  double damping = 0;                 ///< N s/m or N m s/rad
  double rest = 0;                    ///< m or rad
};

/// Three translations along the axes of J, then three rotations: about x, then y, then z as they lie by then.
struct SpringJoint {
  std::array<SpringAxis, 6> axes;
};

using JointKind = std::variant<BallJoint, HingeJoint, SliderJoint, FixedJoint, SpringJoint>;

/// A member of a hinge or slider, given as pointers to member; a default value for other kinds of joints.
template <class Part>
Part part_of(const JointKind& kind, Part HingeJoint::*of_hinge, Part SliderJoint::*of_slider) {
  if (const auto* hinge = std::get_if<HingeJoint>(&kind)) return hinge->*of_hinge;
  if (const auto* slider = std::get_if<SliderJoint>(&kind)) return slider->*of_slider;
  return {};
}
inline std::optional<JointDrive> drive_of(const JointKind& kind) {
  return part_of(kind, &HingeJoint::drive, &SliderJoint::drive);
}
inline std::optional<JointCoupling> coupling_of(const JointKind& kind) {
  return part_of(kind, &HingeJoint::follows, &SliderJoint::follows);
}
/// Sets the coupling of a hinge or slider; does nothing for other kinds.
inline void couple(JointKind& kind, const JointCoupling& coupling) {
  if (auto* hinge = std::get_if<HingeJoint>(&kind)) hinge->follows = coupling;
  if (auto* slider = std::get_if<SliderJoint>(&kind)) slider->follows = coupling;
}

/// Binds bodies that are there in state 0. Its JointId is the index in Scene::joints.
struct JointSpec {
  std::string name;
  JointKind kind;
  BodyId a{};
  std::optional<BodyId> b;  ///< nothing: the world
  Pose X_WJ;
  bool collide = false;  ///< whether a and b collide with each other
  /// The joint breaks for good when it takes more in one substep, in any of its directions. N s or N m s.
  double break_impulse = std::numeric_limits<double>::infinity();
};

}  // namespace aurasim::core
