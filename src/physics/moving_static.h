// Statics that move, as Bullet's bodies: where they are and how fast is set before each step, and nothing changes it.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {

/// How its surface runs, m/s, in the world. The user pointer of a static that moves.
struct Belt {
  btVector3 v_W{0, 0, 0};
};

/// `belt` outlives the body.
inline void make_moving(btRigidBody& fixed, Belt& belt) {
  fixed.setCollisionFlags(fixed.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  fixed.setUserPointer(&belt);
}

inline bool is_moving_static(const btCollisionObject& object) { return object.isKinematicObject(); }

/// 0 of all others.
inline btVector3 belt_of(const btCollisionObject& object) {
  return is_moving_static(object) ? static_cast<const Belt*>(object.getUserPointer())->v_W : btVector3(0, 0, 0);
}

}  // namespace aurasim::physics
