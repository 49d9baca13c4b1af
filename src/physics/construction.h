// Bullet's construction info of bodies and statics.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/scene.h"
#include "physics/bullet_convert.h"
#include "physics/part_surfaces.h"

namespace aurasim::physics {

inline btRigidBody::btRigidBodyConstructionInfo construction_of(double mass, btCollisionShape* shape,
                                                                const core::Vec3& inertia,
                                                                const core::Material& material) {
  const auto scalar = [](double x) { return static_cast<btScalar>(x); };
  btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, shape, to_bullet(inertia));
  const Surface surface = surface_of(material);
  info.m_friction = surface.friction;
  info.m_rollingFriction = surface.rolling_friction;
  info.m_spinningFriction = surface.spinning_friction;
  info.m_restitution = surface.restitution;
  info.m_linearDamping = scalar(material.linear_damping);
  info.m_angularDamping = scalar(material.angular_damping);
  return info;
}

}  // namespace aurasim::physics
