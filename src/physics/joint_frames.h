// The frames of joints in their bodies.
#pragma once

#include "core/joint_motion.h"
#include "core/scene.h"

namespace aurasim::physics {

/// Impulses of motors and of breaking joints are given for this time.
inline constexpr double kImpulseTime_s = 1.0 / 240;

/// The pose of the joint's frame J in a's frame and in b's; without b, in the world's frame. Throws
/// std::invalid_argument if the scene does not have the joint's bodies, or if both are one body.
core::JointFrame frames_of(const core::JointSpec& joint, const core::Scene& scene);

}  // namespace aurasim::physics
