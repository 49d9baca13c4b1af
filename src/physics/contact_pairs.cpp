#include "physics/contact_pairs.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "core/progress.h"
#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

/// Marks bodies whose pairs are being removed. Written into their filter mask, which is not read as a filter after
/// that.
constexpr int kLeaving = 0;

bool is_leaving(const btBroadphaseProxy& proxy) { return proxy.m_collisionFilterMask == kLeaving; }

}  // namespace

/// Walks over all pairs for the narrow phase, which removes no pair.
void ContactPairs::processAllOverlappingPairs(btOverlapCallback* callback, btDispatcher*, const btDispatcherInfo&) {
  btBroadphasePairArray& pairs = getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    core::Progress::mark_now_and_then(static_cast<std::size_t>(i));
    if (i + kPrefetchDistance < pairs.size()) prefetch_pair(pairs[i + kPrefetchDistance]);
    if (i + kPrefetchDistance / 2 < pairs.size()) prefetch_parts(pairs[i + kPrefetchDistance / 2], manifolds_);
    callback->processOverlap(pairs[i]);
  }
}

void ContactPairs::remove_pairs_of(std::span<btBroadphaseProxy* const> leaving, btDispatcher& dispatcher) {
  for (btBroadphaseProxy* proxy : leaving) proxy->m_collisionFilterMask = kLeaving;
  btBroadphasePairArray& pairs = getOverlappingPairArray();
  for (int i = 0; i < pairs.size();) {
    if (is_leaving(*pairs[i].m_pProxy0) || is_leaving(*pairs[i].m_pProxy1)) {
      removeOverlappingPair(pairs[i].m_pProxy0, pairs[i].m_pProxy1, &dispatcher);  // moves the last pair here
    } else {
      ++i;
    }
  }
}

void ContactPairs::cleanProxyFromPairs(btBroadphaseProxy* proxy, btDispatcher* dispatcher) {
  if (!is_leaving(*proxy)) btHashedOverlappingPairCache::cleanProxyFromPairs(proxy, dispatcher);
}

void ContactPairs::removeOverlappingPairsContainingProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) {
  if (!is_leaving(*proxy)) btHashedOverlappingPairCache::removeOverlappingPairsContainingProxy(proxy, dispatcher);
}

}  // namespace aurasim::physics
