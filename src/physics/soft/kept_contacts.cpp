#include "physics/soft/kept_contacts.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace aurasim::physics {
namespace {

/// Contacts are kept if the bodies have moved and turned relative to each other by less, m and rad.
constexpr btScalar kHardly_m = btScalar(2e-4), kHardly_rad = btScalar(2e-4);

/// Position and rotation of B in the frame of A.
struct Relative {
  btVector3 p, q;
};

Relative relative(const btTransform& a, const btTransform& b) {
  btQuaternion q;
  a.getBasis().transposeTimes(b.getBasis()).getRotation(q);
  const btScalar sign = q.w() < 0 ? btScalar(-1) : btScalar(1);
  return {a.invXform(b.getOrigin()), btVector3(q.x(), q.y(), q.z()) * sign};
}

bool has_hardly_moved(const btPersistentManifold& manifold, const btTransform& a, const btTransform& b) {
  const btManifoldPoint& point = manifold.getContactPoint(0);
  if (point.m_contactERP != 1) return false;
  const Relative now = relative(a, b);
  const btVector3 turned = now.q - btVector3(point.m_contactMotion1, point.m_contactMotion2, point.m_frictionCFM);
  return (now.p - point.m_lateralFrictionDir2).length2() < kHardly_m * kHardly_m &&
         4 * turned.length2() < kHardly_rad * kHardly_rad;
}

}  // namespace

bool keep_contacts(btPersistentManifold& manifold) {
  const btTransform& a = manifold.getBody0()->getWorldTransform();
  const btTransform& b = manifold.getBody1()->getWorldTransform();
  if (!has_hardly_moved(manifold, a, b)) return false;
  const btScalar most = manifold.getContactBreakingThreshold();
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_normalWorldOnB = b.getBasis() * point.m_lateralFrictionDir1;
    point.m_positionWorldOnA = a(point.m_localPointA);
    point.m_positionWorldOnB = b(point.m_localPointB);
    const btVector3 way = point.m_positionWorldOnA - point.m_positionWorldOnB;
    point.m_distance1 = way.dot(point.m_normalWorldOnB);
    ++point.m_lifeTime;
    const btVector3 aside = way - point.m_normalWorldOnB * point.m_distance1;
    if (point.m_distance1 > most || aside.length2() > most * most) manifold.removeContactPoint(i);
  }
  return true;
}

void note_contacts(btPersistentManifold& manifold) {
  const btTransform& b = manifold.getBody1()->getWorldTransform();
  const Relative now = relative(manifold.getBody0()->getWorldTransform(), b);
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_lateralFrictionDir1 = point.m_normalWorldOnB * b.getBasis();
    point.m_lateralFrictionDir2 = now.p;
    point.m_contactMotion1 = now.q.x(), point.m_contactMotion2 = now.q.y(), point.m_frictionCFM = now.q.z();
    point.m_contactERP = 1;
  }
}

}  // namespace aurasim::physics
