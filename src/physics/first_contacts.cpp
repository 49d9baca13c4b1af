#include "physics/first_contacts.h"

#include <algorithm>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

std::uint32_t last_touch(const btPersistentManifold& manifold) {
  return static_cast<std::uint32_t>(manifold.m_companionIdA);
}
std::uint32_t first_touch(const btPersistentManifold& manifold) {
  return static_cast<std::uint32_t>(manifold.m_companionIdB);
}

const btManifoldPoint& deepest_point(const btPersistentManifold& manifold) {
  int deepest = 0;
  for (int i = 1; i < manifold.getNumContacts(); ++i) {
    if (manifold.getContactPoint(i).getDistance() < manifold.getContactPoint(deepest).getDistance()) deepest = i;
  }
  return manifold.getContactPoint(deepest);
}

bool is_compound(const btCollisionObject& object) { return object.getCollisionShape()->isCompound(); }

bool is_moving(const btCollisionObject& object) { return !object.isStaticOrKinematicObject(); }

FirstContact describe(const btPersistentManifold& manifold) {
  const btManifoldPoint& point = deepest_point(manifold);
  const btVector3 p = (point.getPositionWorldOnA() + point.getPositionWorldOnB()) / 2;
  const auto velocity = [&p](const btCollisionObject* object) {
    return btRigidBody::upcast(object)->getVelocityInLocalPoint(p - object->getWorldTransform().getOrigin());
  };
  const btVector3 relative = velocity(manifold.getBody0()) - velocity(manifold.getBody1());
  return {manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex(), -point.getDistance(),
          relative.length(), p};
}

}  // namespace

void FirstContacts::look(std::span<btPersistentManifold* const> manifolds, btOverlappingPairCache& pairs) {
  new_.clear();
  for_each_touching(manifolds, [this](btPersistentManifold& manifold) {
    if (note(manifold)) new_.push_back(&manifold);
  });
  report(new_, pairs);
}

bool FirstContacts::note(btPersistentManifold& manifold) const {
  if (!is_moving(*manifold.getBody0()) || !is_moving(*manifold.getBody1())) return false;
  const bool is_new = last_touch(manifold) != now_;
  if (is_new) manifold.m_companionIdB = static_cast<int>(now_ + 1);
  manifold.m_companionIdA = static_cast<int>(now_ + 1);
  return is_new;
}

void FirstContacts::report(std::span<btPersistentManifold* const> came, btOverlappingPairCache& pairs) {
  ++now_;
  for (const btPersistentManifold* manifold : came) {
    if (is_compound(*manifold->getBody0()) || is_compound(*manifold->getBody1())) {
      report_pair(*manifold, pairs);
    } else {
      found_.push_back(describe(*manifold));
    }
  }
}

bool FirstContacts::touched_before(const btPersistentManifold& manifold) const {
  const bool in_the_last_substep = last_touch(manifold) == now_ - 1;
  const bool since_an_earlier_one = last_touch(manifold) == now_ && first_touch(manifold) != now_;
  return in_the_last_substep || since_an_earlier_one;
}

/// Reports the pair of a manifold if its contact is new. A pair with compounds has several manifolds: it is new if none
/// of them touched before, and its deepest point counts.
void FirstContacts::report_pair(const btPersistentManifold& manifold, btOverlappingPairCache& pairs) {
  auto* const proxy0 = const_cast<btBroadphaseProxy*>(manifold.getBody0()->getBroadphaseHandle());
  auto* const proxy1 = const_cast<btBroadphaseProxy*>(manifold.getBody1()->getBroadphaseHandle());
  collect_manifolds(*pairs.findPair(proxy0, proxy1), of_pair_);
  const btPersistentManifold* deepest = &manifold;
  for (const PartManifold& part : of_pair_) {
    if (touched_before(*part.manifold)) return;
    if (part.manifold->getNumContacts() == 0) continue;
    if (deepest_point(*part.manifold).getDistance() < deepest_point(*deepest).getDistance()) deepest = part.manifold;
  }
  found_.push_back(describe(*deepest));
}

void FirstContacts::add(const FirstContact& contact, const btBroadphasePair& pair) {
  collect_manifolds(pair, of_pair_);
  const auto touched = [this](const PartManifold& part) { return touched_before(*part.manifold); };
  if (std::ranges::none_of(of_pair_, touched)) found_.push_back(contact);
  for (const PartManifold& part : of_pair_) know(*part.manifold);
}

void FirstContacts::forget(btPersistentManifold& manifold) { manifold.m_companionIdA = manifold.m_companionIdB = 0; }

void FirstContacts::know(btPersistentManifold& manifold) const {
  manifold.m_companionIdA = static_cast<int>(now_);
  manifold.m_companionIdB = static_cast<int>(now_ - 1);
}

}  // namespace aurasim::physics
