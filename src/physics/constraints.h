// Makes Bullet's constraints of the scene's joints.
#pragma once

#include <memory>

#include "core/scene.h"
#include "physics/joint_frames.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

/// Makes the constraint of a joint. The caller sets the joint's JointAxes as its user pointer before it is solved. If
/// the joint holds on to the world, `b` is a body without mass at the origin. Of a constraint's state only "enabled"
/// outlives a substep: rows start from impulse 0 in every solve, and angles and positions are measured anew. The scene
/// gives the impulses of motors and of breaking joints for kImpulseTime_s; they are scaled to `substep_s`.
std::unique_ptr<btTypedConstraint> make_constraint(const core::JointSpec& joint, const core::JointFrame& frames,
                                                   btRigidBody& a, btRigidBody& b, double substep_s);

}  // namespace aurasim::physics
