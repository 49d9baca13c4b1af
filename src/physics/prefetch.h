// Bodies, pairs and contacts lie all over the memory, and the loops over them mostly waited for it. Now they ask for
// what comes next while they work on what came before.
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

/// So many objects ahead; their parts half as many. 8 to 16 do alike.
inline constexpr int kPrefetchDistance = 16;

using core::prefetch;

/// What a manifold is between and how many points it has: all of it but the points.
inline void prefetch_head(const btPersistentManifold& manifold) {
  const auto* const end = reinterpret_cast<const char*>(&manifold + 1);
  const auto* const points_end = reinterpret_cast<const char*>(&manifold.getContactPoint(0) + MANIFOLD_CACHE_SIZE);
  prefetch(points_end, static_cast<std::size_t>(end - points_end));
}

/// Of a manifold whose head is here.
inline void prefetch_points(const btPersistentManifold& manifold) {
  const int count = manifold.getNumContacts();
  if (count > 0) prefetch(&manifold.getContactPoint(0), static_cast<std::size_t>(count) * sizeof(btManifoldPoint));
}

inline void prefetch_pair(const btBroadphasePair& pair) {
  prefetch(pair.m_pProxy0, sizeof(btBroadphaseProxy));
  prefetch(pair.m_pProxy1, sizeof(btBroadphaseProxy));
  if (pair.m_algorithm != nullptr) prefetch(pair.m_algorithm, sizeof(btCollisionAlgorithm));
}

/// Where a body is and how it moves, and what resists.
inline void prefetch_motion(const btRigidBody& body) {
  prefetch(&body.getWorldTransform(), sizeof(btTransform));
  prefetch(&body.getInvInertiaTensorWorld(), sizeof(btMatrix3x3) + 3 * sizeof(btVector3));  // the speeds come next
}

/// What an object is, whether it sleeps, and its user indices.
inline void prefetch_flags(const btCollisionObject& object) {
  constexpr std::size_t kFlags = 240, kSome = 128;  // so far before the end
  prefetch(reinterpret_cast<const char*>(&object + 1) - kFlags, kSome);
}

/// With where it is; not what Bullet keeps for frames in between.
inline void prefetch_object(const btCollisionObject& object) {
  prefetch(&object.getWorldTransform(), sizeof(btTransform));
  prefetch_flags(object);
}

/// Of a pair that is here itself.
inline void prefetch_parts(const btBroadphasePair& pair, btManifoldArray& manifolds) {
  prefetch_object(*static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject));
  prefetch_object(*static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject));
  if (pair.m_algorithm == nullptr) return;
  manifolds.resizeNoInitialize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) prefetch_head(*manifolds[i]);
}

/// Calls `visit(manifold)` for each that has a point.
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
