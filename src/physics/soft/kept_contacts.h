// The narrow phase of the soft step: who has hardly moved against whom since their contacts were last told keeps them,
// with their present distances.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

class btCollisionDispatcher;
class btPersistentManifold;

namespace aurasim::physics {

/// What it compares with lies in fields of the contact points that Bullet's solvers need and the soft step does not, so
/// a hand-off carries it: in m_lateralFrictionDir1 the normal, in the frame of B; in m_lateralFrictionDir2 where B was
/// in the frame of A, in m_contactMotion1, m_contactMotion2 and m_frictionCFM its rotation (x, y, z of the quaternion
/// with w >= 0); m_contactERP is 1.
class KeptContacts final : private btOverlapCallback {
 public:
  void look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

 private:
  bool processOverlap(btBroadphasePair& pair) override;
  btPersistentManifold* only_manifold(const btBroadphasePair& pair);

  btCollisionDispatcher* dispatcher_ = nullptr;
  const btDispatcherInfo* info_ = nullptr;
  btManifoldArray manifolds_;
};

}  // namespace aurasim::physics
