// Prefetches bodies, pairs and contacts, which are scattered in memory: loops over them mostly waited for it. A loop
// now requests later objects while it works on the present one.
#pragma once

#include <cstddef>
#include <span>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/prefetch.h"

namespace aurasim::physics {

/// Objects are prefetched so many iterations ahead, their parts half as many. 8 to 16 are equally fast.
inline constexpr int kPrefetchDistance = 16;

using core::prefetch;

/// Prefetches a manifold except its points: its bodies and the number of points.
inline void prefetch_head(const btPersistentManifold& manifold) {
  const auto* const end = reinterpret_cast<const char*>(&manifold + 1);
  const auto* const points_end = reinterpret_cast<const char*>(&manifold.getContactPoint(0) + MANIFOLD_CACHE_SIZE);
  prefetch(points_end, static_cast<std::size_t>(end - points_end));
}

/// Prefetches the points of a manifold whose head has been prefetched.
inline void prefetch_points(const btPersistentManifold& manifold) {
  const int count = manifold.getNumContacts();
  if (count > 0) prefetch(&manifold.getContactPoint(0), static_cast<std::size_t>(count) * sizeof(btManifoldPoint));
}

/// Prefetches the impulses of a contact point.
inline void prefetch_impulses(const btManifoldPoint& point) {
  prefetch(&point.m_appliedImpulse, 4 * sizeof(btScalar));  // the other impulses follow in memory
}

inline void prefetch_pair(const btBroadphasePair& pair) {
  prefetch(pair.m_pProxy0, sizeof(btBroadphaseProxy));
  prefetch(pair.m_pProxy1, sizeof(btBroadphaseProxy));
  if (pair.m_algorithm != nullptr) prefetch(pair.m_algorithm, sizeof(btCollisionAlgorithm));
}

/// Prefetches pose, velocities and inertia of a body.
inline void prefetch_motion(const btRigidBody& body) {
  prefetch(&body.getWorldTransform(), sizeof(btTransform));
  // the velocities follow in memory
  prefetch(&body.getInvInertiaTensorWorld(), sizeof(btMatrix3x3) + 3 * sizeof(btVector3));
}

/// Prefetches type, activation state and user indices of an object.
inline void prefetch_flags(const btCollisionObject& object) {
  constexpr std::size_t kFlags = 240, kSome = 128;  // octets before the end of the object, and their number
  prefetch(reinterpret_cast<const char*>(&object + 1) - kFlags, kSome);
}

/// Prefetches pose and flags of an object, without Bullet's fields for interpolation.
inline void prefetch_object(const btCollisionObject& object) {
  prefetch(&object.getWorldTransform(), sizeof(btTransform));
  prefetch_flags(object);
}

/// Prefetches objects and manifolds of a pair that has been prefetched itself.
inline void prefetch_parts(const btBroadphasePair& pair, btManifoldArray& manifolds) {
  prefetch_object(*static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject));
  prefetch_object(*static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject));
  if (pair.m_algorithm == nullptr) return;
  manifolds.resizeNoInitialize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) prefetch_head(*manifolds[i]);
}

/// Calls `visit(manifold)` for each manifold that has a point.
template <class Visit>
void for_each_touching(std::span<btPersistentManifold* const> manifolds, Visit&& visit) {
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    if (i + kPrefetchDistance < manifolds.size()) prefetch_head(*manifolds[i + kPrefetchDistance]);
    if (manifolds[i]->getNumContacts() > 0) visit(*manifolds[i]);
  }
}

inline std::span<btPersistentManifold* const> manifolds_of(btDispatcher& dispatcher) {
  return {dispatcher.getInternalManifoldPointer(), static_cast<std::size_t>(dispatcher.getNumManifolds())};
}

}  // namespace aurasim::physics
