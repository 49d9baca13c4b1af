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
  for (btBroadphaseProxy* proxy : leaving) {
    proxy->m_collisionFilterMask = kLeaving;
    sleeping_.remove_all_of(*proxy);
  }
  btBroadphasePairArray& pairs = getOverlappingPairArray();
  for (int i = 0; i < pairs.size();) {
    if (is_leaving(*pairs[i].m_pProxy0) || is_leaving(*pairs[i].m_pProxy1)) {
      removeOverlappingPair(pairs[i].m_pProxy0, pairs[i].m_pProxy1, &dispatcher);  // moves the last pair here
    } else {
      ++i;
    }
  }
}

/// Bullet's lists only grow, so the pairs are put into new ones.
void ContactPairs::free_spare_memory() {
  constexpr int kFew = 1024, kOneIn = 8;
  btBroadphasePairArray& pairs = getOverlappingPairArray();
  if (pairs.capacity() <= kFew || pairs.capacity() < kOneIn * pairs.size()) return;
  btBroadphasePairArray kept;
  kept.copyFromArray(pairs);
  pairs.clear(), m_hashTable.clear(), m_next.clear();
  pairs.reserve(kFew / 2);
  m_hashTable.resize(kFew / 2, BT_NULL_PAIR), m_next.resize(kFew / 2, BT_NULL_PAIR);
  for (int i = 0; i < kept.size(); ++i) {
    btBroadphasePair* const pair = addOverlappingPair(kept[i].m_pProxy0, kept[i].m_pProxy1);
    pair->m_algorithm = kept[i].m_algorithm;
    pair->m_internalInfo1 = kept[i].m_internalInfo1;
  }
}

void ContactPairs::cleanProxyFromPairs(btBroadphaseProxy* proxy, btDispatcher* dispatcher) {
  if (!is_leaving(*proxy)) btHashedOverlappingPairCache::cleanProxyFromPairs(proxy, dispatcher);
}

void ContactPairs::removeOverlappingPairsContainingProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) {
  if (!is_leaving(*proxy)) btHashedOverlappingPairCache::removeOverlappingPairsContainingProxy(proxy, dispatcher);
}

}  // namespace aurasim::physics
