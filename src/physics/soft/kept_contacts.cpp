#include "physics/soft/kept_contacts.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btAabbUtil2.h>

namespace aurasim::physics {
namespace {

/// Who has moved or turned less, as seen by the other, keeps contacts: m, rad.
constexpr btScalar kHardly_m = btScalar(2e-4), kHardly_rad = btScalar(2e-4);

/// Of B in the frame of A.
struct Relative {
  btVector3 p, q;
};

Relative relative(const btPersistentManifold& manifold) {
  const btTransform& a = manifold.getBody0()->getWorldTransform();
  const btTransform& b = manifold.getBody1()->getWorldTransform();
  btQuaternion q;
  a.getBasis().transposeTimes(b.getBasis()).getRotation(q);
  if (q.w() < 0) q = -q;
  return {a.invXform(b.getOrigin()), {q.x(), q.y(), q.z()}};
}

void remember(btPersistentManifold& manifold) {
  const Relative now = relative(manifold);
  const btMatrix3x3& b = manifold.getBody1()->getWorldTransform().getBasis();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_lateralFrictionDir1 = point.m_normalWorldOnB * b;
    point.m_lateralFrictionDir2 = now.p;
    point.m_contactMotion1 = now.q.x(), point.m_contactMotion2 = now.q.y(), point.m_frictionCFM = now.q.z();
    point.m_contactERP = 1;
  }
}

bool has_hardly_moved(const btPersistentManifold& manifold) {
  const btManifoldPoint& point = manifold.getContactPoint(0);
  if (point.m_contactERP != 1) return false;
  const Relative now = relative(manifold);
  const btVector3 turned = now.q - btVector3(point.m_contactMotion1, point.m_contactMotion2, point.m_frictionCFM);
  return (now.p - point.m_lateralFrictionDir2).length2() < kHardly_m * kHardly_m &&
         4 * turned.length2() < kHardly_rad * kHardly_rad;
}

void refresh(btPersistentManifold& manifold) {
  const btTransform& b = manifold.getBody1()->getWorldTransform();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_normalWorldOnB = b.getBasis() * point.m_lateralFrictionDir1;
  }
  manifold.refreshContactPoints(manifold.getBody0()->getWorldTransform(), b);
}

bool bounds_overlap(const btBroadphasePair& pair) {
  return TestAabbAgainstAabb2(pair.m_pProxy0->m_aabbMin, pair.m_pProxy0->m_aabbMax, pair.m_pProxy1->m_aabbMin,
                              pair.m_pProxy1->m_aabbMax);
}

const btCollisionObject& object_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

}  // namespace

void KeptContacts::look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher,
                        const btDispatcherInfo& info) {
  dispatcher_ = &dispatcher;
  info_ = &info;
  pairs.processAllOverlappingPairs(this, &dispatcher, info);
}

/// Null if there are none or several, as between compounds.
btPersistentManifold* KeptContacts::only_manifold(const btBroadphasePair& pair) {
  if (pair.m_algorithm == nullptr) return nullptr;
  manifolds_.resizeNoInitialize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds_);
  return manifolds_.size() == 1 && manifolds_[0]->getNumContacts() > 0 ? manifolds_[0] : nullptr;
}

bool KeptContacts::processOverlap(btBroadphasePair& pair) {
  const btCollisionObject& a = object_of(*pair.m_pProxy0);
  const btCollisionObject& b = object_of(*pair.m_pProxy1);
  if (!a.isActive() && !b.isActive()) return false;
  const bool whole = !a.getCollisionShape()->isCompound() && !b.getCollisionShape()->isCompound();
  if (whole && bounds_overlap(pair)) {
    btPersistentManifold* const manifold = only_manifold(pair);
    if (manifold != nullptr && has_hardly_moved(*manifold)) {
      refresh(*manifold);
      return false;
    }
  }
  dispatcher_->getNearCallback()(pair, *dispatcher_, *info_);
  if (!whole) return false;
  if (btPersistentManifold* const manifold = only_manifold(pair)) remember(*manifold);
  return false;
}

}  // namespace aurasim::physics
