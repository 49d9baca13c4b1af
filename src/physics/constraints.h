// The scene's joints as Bullet's constraints.
#pragma once

#include <memory>

#include "core/scene.h"

class btRigidBody;
class btTypedConstraint;

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

/// `b` is a body without mass at the origin if the joint holds on to the world. Nothing of Bullet's constraints
/// outlives a substep but whether they are enabled: rows start from impulse 0 in every solve, angles and positions are
/// measured anew from the poses. How strong motors are and what joints bear follows from the scene alone: as the
/// impulses that it names in kImpulseTime_s, so in a substep of `substep_s` by its share of that.
std::unique_ptr<btTypedConstraint> make_constraint(const core::JointSpec& joint, const JointFrames& frames,
                                                   btRigidBody& a, btRigidBody& b, double substep_s);

}  // namespace aurasim::physics
