// Where a joint stands and how fast it moves, from the states of its two bodies: pure geometry.
#pragma once

#include <optional>

#include "core/body_state.h"
#include "core/joint.h"

namespace aurasim::core {

/// J in the two bodies' frames, for good; without b, in the world's.
struct JointFrame {
  Pose X_AJ;
  Pose X_BJ;
};

/// From the bodies' poses in state 0.
JointFrame frame_of(const JointSpec& joint, const Pose& X_WA, const Pose& X_WB);

/// The one coordinate that the joint leaves free: 0 to 2: along x, y, z of b's J; 3 to 5: about them. Hinges have 5,
/// sliders 2, springs theirs if they have one that is not held. Nothing: the joint has none, or several.
std::optional<int> coordinate_of(const JointSpec& joint);

/// Without an effort, and an angle in (-pi, pi]. `a`, `b`: origin, rotation, velocity and spin of the bodies. Without
/// b: a BodyState as it is by itself.
JointMotion joint_motion(const JointFrame& frame, int coordinate, const BodyState& a, const BodyState& b);

}  // namespace aurasim::core
