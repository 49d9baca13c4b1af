// Bullet's pairs of near bodies, with a quick way through them, and out of them for many bodies at once.
#pragma once

#include <span>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

namespace aurasim::physics {

/// Bullet walks over all pairs twice for each body that leaves. A cluster leaves in one walk instead.
class ContactPairs : public btHashedOverlappingPairCache {
 public:
  /// Forgets every pair of these bodies, with its contacts. They must leave the broadphase next.
  void remove_pairs_of(std::span<btBroadphaseProxy* const> leaving, btDispatcher& dispatcher);

  using btHashedOverlappingPairCache::processAllOverlappingPairs;
  void processAllOverlappingPairs(btOverlapCallback* callback, btDispatcher* dispatcher,
                                  const btDispatcherInfo& info) override;

  void cleanProxyFromPairs(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;

 private:
  btManifoldArray manifolds_;  ///< of a pair that comes next
};

}  // namespace aurasim::physics
