// The soft step notes this in a pair of near objects.
#pragma once

#include <bit>
#include <cstdint>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "physics/soft/touch.h"

namespace aurasim::physics {

/// Facts about a pair that hold as long as it lasts. They are kept in a field of the pair that Bullet does not use,
/// because reading the bodies would miss the cache. All 0: not known yet.
struct PairNote {
  static constexpr std::uint32_t kKnown = 1u << 31, kMayTouch = 1u << 30, kSlot = kMayTouch - 1;

  std::uint32_t a = 0, b_and_flags = 0;  ///< slots of the bodies

  bool is_known() const { return (b_and_flags & kKnown) != 0; }
  /// False if a joint keeps the bodies from touching.
  bool may_touch() const { return (b_and_flags & kMayTouch) != 0; }
  std::uint32_t b() const { return b_and_flags & kSlot; }
};

inline PairNote noted(const btBroadphasePair& pair) { return std::bit_cast<PairNote>(pair.m_internalInfo1); }

inline PairNote note_of(btBroadphasePair& pair) {
  if (noted(pair).is_known()) return noted(pair);
  const btCollisionObject& a = *static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const btCollisionObject& b = *static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  const bool may_touch = a.checkCollideWith(&b) && b.checkCollideWith(&a);
  const PairNote note = {slot_of(a), slot_of(b) | PairNote::kKnown | (may_touch ? PairNote::kMayTouch : 0)};
  pair.m_internalInfo1 = std::bit_cast<void*>(note);
  return note;
}

}  // namespace aurasim::physics
