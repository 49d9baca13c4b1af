// Position and speed of a joint's coordinate from the states of its two bodies. Pure geometry.
#pragma once

#include <optional>

#include "core/body_state.h"
#include "core/joint.h"

namespace aurasim::core {

/// Constant poses of the joint's frame J in the frames of the two bodies. Without b, X_BJ is the pose in the world.
struct JointFrame {
  Pose X_AJ;
  Pose X_BJ;
};

/// The frames of `joint`, from the bodies' poses in state 0.
JointFrame frame_of(const JointSpec& joint, const Pose& X_WA, const Pose& X_WB);

/// The one coordinate that the joint leaves free. 0 to 2: along x, y, z of b's J; 3 to 5: about them. Hinges have 5,
/// sliders 2, springs the one axis that is not locked. Nothing if the joint leaves no coordinate free, or several.
std::optional<int> coordinate_of(const JointSpec& joint);

/// Motion of the joint along `coordinate`. Its effort is 0, and an angle is in (-pi, pi]. Uses pose and velocities of
/// `a` and `b`. For a joint without b, `b` is a default BodyState.
JointMotion joint_motion(const JointFrame& frame, int coordinate, const BodyState& a, const BodyState& b);

}  // namespace aurasim::core
