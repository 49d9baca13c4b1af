// Statics that move, as Bullet's kinematic bodies: pose and velocity are set before each step, and nothing else changes
// them.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {

/// Surface velocity of a static's belt, m/s, in the world. The user pointer of a moving static points to one.
struct Belt {
  btVector3 v_W{0, 0, 0};
};

/// Turns a static into one that moves. `belt` has to outlive the body.
inline void make_moving(btRigidBody& fixed, Belt& belt) {
  fixed.setCollisionFlags(fixed.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  fixed.setUserPointer(&belt);
}

inline bool is_moving_static(const btCollisionObject& object) { return object.isKinematicObject(); }

/// Surface velocity of a moving static; 0 for all other objects.
inline btVector3 belt_of(const btCollisionObject& object) {
  return is_moving_static(object) ? static_cast<const Belt*>(object.getUserPointer())->v_W : btVector3(0, 0, 0);
}

}  // namespace aurasim::physics
