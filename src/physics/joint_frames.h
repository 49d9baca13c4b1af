// Where joints are in their bodies.
#pragma once

#include "core/joint_motion.h"
#include "core/scene.h"

namespace aurasim::physics {

/// The impulses of motors and those that break joints are those of so long a time.
inline constexpr double kImpulseTime_s = 1.0 / 240;

/// Without b, in Bullet's frame. `p_WO`: where Bullet's coordinates begin. Throws std::invalid_argument if the scene
/// has no such bodies, or one body twice.
core::JointFrame frames_of(const core::JointSpec& joint, const core::Scene& scene, const core::Vec3& p_WO);

}  // namespace aurasim::physics
