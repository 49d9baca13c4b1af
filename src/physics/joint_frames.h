// Where joints are in their bodies.
#pragma once

#include "core/scene.h"

namespace aurasim::physics {

/// The impulses of motors and those that break joints are those of so long a time.
inline constexpr double kImpulseTime_s = 1.0 / 240;

/// Where the joint's frame J is in its bodies, for good. Without b, in Bullet's frame.
struct JointFrames {
  core::Pose X_AJ;
  core::Pose X_BJ;
};

/// `p_WO`: where Bullet's coordinates begin. Throws std::invalid_argument if the scene has no such bodies, or one body
/// twice.
JointFrames frames_of(const core::JointSpec& joint, const core::Scene& scene, const core::Vec3& p_WO);

}  // namespace aurasim::physics
