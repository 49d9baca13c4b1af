#include "physics/contact_impulses.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/prefetch.h"

namespace aurasim::physics {

void ContactImpulses::add(int a, int b, const btVector3& p, const btVector3& normal, double impulse) {
  if (!(impulse > 0)) return;
  const bool swaps = a < b;
  ContactSum& sum = sums_[swaps ? std::pair(b, a) : std::pair(a, b)];
  const auto weight = static_cast<btScalar>(impulse);
  sum.impulse += impulse;
  sum.p += weight * p;
  sum.normal += (swaps ? -weight : weight) * normal;
}

void ContactImpulses::look(std::span<btPersistentManifold* const> manifolds) {
  for_each_touching(manifolds, [this](const btPersistentManifold& manifold) {
    const btCollisionObject& a = *manifold.getBody0();
    const btCollisionObject& b = *manifold.getBody1();
    if (!a.isActive() && !b.isActive()) return;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const btVector3 p = (point.getPositionWorldOnA() + point.getPositionWorldOnB()) / 2;
      add(a.getUserIndex(), b.getUserIndex(), p, -point.m_normalWorldOnB, static_cast<double>(point.m_appliedImpulse));
    }
  });
}

}  // namespace aurasim::physics
