#include "physics/sleeping_pairs.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/soft/touch.h"

namespace aurasim::physics {
namespace {

const btCollisionObject& object_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

// The contacts of a pair are packed as the number of manifolds, in two octets, and then each manifold: the number of
// its points, and whether its first body is the second one of the pair, in one octet, and the points.
constexpr std::uint8_t kCount = 0x7f, kSwapped = 0x80;

}  // namespace

void SleepingPairs::put(const btBroadphasePair& pair) {
  bytes_.assign(2, 0);
  unsigned count = 0;
  btManifoldArray manifolds;
  if (pair.m_algorithm != nullptr) pair.m_algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() == 0) continue;
    ++count;
    const bool swapped = manifolds[i]->getBody0() != &object_of(*pair.m_pProxy0);
    bytes_.push_back(static_cast<std::uint8_t>(manifolds[i]->getNumContacts() | (swapped ? kSwapped : 0)));
    pack_points(*manifolds[i], bytes_);
  }
  bytes_[0] = static_cast<std::uint8_t>(count), bytes_[1] = static_cast<std::uint8_t>(count >> 8);
  Pair kept{pair.m_pProxy0, pair.m_pProxy1, nullptr};
  if (count > 0) {
    kept.contacts = std::make_unique_for_overwrite<std::uint8_t[]>(bytes_.size());
    std::ranges::copy(bytes_, kept.contacts.get());
  }
  pairs_.add(slot_of(object_of(*pair.m_pProxy0)), slot_of(object_of(*pair.m_pProxy1)), std::move(kept));
}

/// Goes along the pairs of both bodies, because one of the two may have many.
std::uint32_t SleepingPairs::find(const btBroadphaseProxy& a, const btBroadphaseProxy& b) const {
  if (empty()) return kNone;
  std::uint32_t links[2] = {kNone, kNone};
  const std::uint32_t slots[2] = {slot_of(object_of(a)), slot_of(object_of(b))};
  if (slots[0] == 0 && slots[1] == 0) return kNone;
  for (int i = 0; i < 2; ++i) {
    if (slots[i] == 0) continue;  // along the other one's
    if (!has(slots[i])) return kNone;
    links[i] = pairs_.first(slots[i]);
  }
  const auto matches = [&](const Pair& pair) {
    return (pair.proxy0 == &a && pair.proxy1 == &b) || (pair.proxy0 == &b && pair.proxy1 == &a);
  };
  for (;;) {
    for (int i = 0; i < 2; ++i) {
      if (slots[i] == 0) continue;
      if (links[i] == kNone) return kNone;
      if (matches(pairs_.item(links[i] / 2))) return links[i] / 2;
      links[i] = pairs_.next(links[i]);
    }
  }
}

void SleepingPairs::remove(const btBroadphaseProxy& a, const btBroadphaseProxy& b) {
  if (const std::uint32_t at = find(a, b); at != kNone) pairs_.take(at);
}

void SleepingPairs::remove_all_of(const btBroadphaseProxy& object) {
  if (empty()) return;
  if (const std::uint32_t slot = slot_of(object_of(object)); slot != 0) {
    while (has(slot)) take_one(slot);
    return;
  }
  std::vector<std::uint32_t> of_static;
  pairs_.for_each([&](std::uint32_t at) {
    if (pairs_.item(at).proxy0 == &object || pairs_.item(at).proxy1 == &object) of_static.push_back(at);
  });
  for (const std::uint32_t at : of_static) pairs_.take(at);
}

SleepingPairs::ContactReader::ContactReader(const Pair& pair)
    : pair_(pair), at_(pair.contacts.get() + 2), left_(pair.contacts[0] + 256U * pair.contacts[1]) {}

ContactView SleepingPairs::ContactReader::next() {
  const btCollisionObject &first = object_of(*pair_.proxy0), &second = object_of(*pair_.proxy1);
  const bool swapped = (*at_ & kSwapped) != 0;
  const std::size_t count = *at_ & kCount;
  const btCollisionObject &body0 = swapped ? second : first, &body1 = swapped ? first : second;
  const ContactView view(body0, body1, count, ++at_);
  if (--left_ > 0) {
    PackedPoints points(at_, body0, body1);
    for (std::size_t i = 0; i < count; ++i) points.next();
    at_ = points.end();
  }
  return view;
}

}  // namespace aurasim::physics
