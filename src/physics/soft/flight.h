// The flight of bodies that touch nothing, in one step.
#pragma once

#include <LinearMath/btVector3.h>

class btRigidBody;

namespace aurasim::physics {

/// Accelerations of a body by the forces on it.
struct Pushed {
  btVector3 v{0, 0, 0}, w{0, 0, 0};
  bool any = false;
};
Pushed pushed(const btRigidBody& body);

/// Moves a body that touches nothing. Half of a torque's impulse acts before the turn and half after.
void fly(btRigidBody& body, const btVector3& gravity, btScalar step_s);

}  // namespace aurasim::physics
