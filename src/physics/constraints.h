// The scene's joints as Bullet's constraints.
#pragma once

#include <memory>

#include "core/scene.h"
#include "physics/joint_frames.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

/// With the joint's JointAxes as user pointer, before it is solved. `b` is a body without mass at the origin if the
/// joint holds on to the world. Nothing of Bullet's constraints outlives a substep but whether they are enabled: rows
/// start from impulse 0 in every solve, angles and positions are measured anew from the poses. How strong motors are
/// and what joints bear follows from the scene alone: as the impulses that it names in kImpulseTime_s, so in a substep
/// of `substep_s` by its share of that.
std::unique_ptr<btTypedConstraint> make_constraint(const core::JointSpec& joint, const core::JointFrame& frames,
                                                   btRigidBody& a, btRigidBody& b, double substep_s);

}  // namespace aurasim::physics
