// Bullet's cache of pairs of near bodies, with a faster walk over all pairs, and fast removal of many bodies at once.
#pragma once

#include <span>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "physics/sleeping_pairs.h"

namespace aurasim::physics {

/// Bullet's cache walks over all pairs twice for each body that leaves. Here a whole cluster leaves in one walk.
class ContactPairs : public btHashedOverlappingPairCache {
 public:
  /// Removes all pairs of these bodies with their contacts. The caller must then remove the bodies from the broadphase.
  void remove_pairs_of(std::span<btBroadphaseProxy* const> leaving, btDispatcher& dispatcher);

  /// Pairs that are near, too, and that nothing is to be done about. Whoever adds a pair has to look there first.
  SleepingPairs& sleeping() { return sleeping_; }
  const SleepingPairs& sleeping() const { return sleeping_; }
  /// Is the pair known, here or among the sleeping ones? Several threads may ask.
  bool contains(btBroadphaseProxy& a, btBroadphaseProxy& b) {
    return findPair(&a, &b) != nullptr || sleeping_.contains(a, b);
  }
  /// Frees the memory of pairs that are no longer here, if it is most of it.
  void free_spare_memory();

  using btHashedOverlappingPairCache::processAllOverlappingPairs;
  void processAllOverlappingPairs(btOverlapCallback* callback, btDispatcher* dispatcher,
                                  const btDispatcherInfo& info) override;

  void cleanProxyFromPairs(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;

 private:
  SleepingPairs sleeping_;
  btManifoldArray manifolds_;  ///< scratch: manifolds of a pair that is prefetched
};

}  // namespace aurasim::physics
