#include "physics/soft/ahead.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "physics/hull_axes.h"
#include "physics/hull_faces.h"

namespace aurasim::physics {
namespace {

struct Hit : btCollisionWorld::ClosestConvexResultCallback {
  using ClosestConvexResultCallback::ClosestConvexResultCallback;

  btScalar addSingleResult(btCollisionWorld::LocalConvexResult& found, bool in_world) override {
    part_of_cast = casts;
    part_of_target = found.m_localShapeInfo != nullptr ? found.m_localShapeInfo->m_triangleIndex : -1;
    return ClosestConvexResultCallback::addSingleResult(found, in_world);
  }

  int casts = -1;  ///< part of a compound that is being cast; -1: none
  int part_of_cast = -1, part_of_target = -1;
};

void cast(const btCollisionShape& shape, const btTransform& from, const btVector3& way, const btCollisionObject& at,
          Hit& hit) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      hit.casts = i;
      cast(*compound.getChildShape(i), from * compound.getChildTransform(i), way, at, hit);
    }
  } else if (shape.isConvex()) {
    const btCollisionObjectWrapper target(nullptr, at.getCollisionShape(), &at, at.getWorldTransform(), -1, -1);
    btTransform to = from;
    to.setOrigin(from.getOrigin() + way);
    btCollisionWorld::objectQuerySingleInternal(static_cast<const btConvexShape*>(&shape), from, to, &target, hit, 0);
  }
}

bool can_be_cast(const btCollisionObject& object) {
  const btCollisionShape& shape = *object.getCollisionShape();
  return !object.isStaticObject() && (shape.isConvex() || shape.isCompound());
}

/// Hulls and boxes that pass each other are most of those that might meet, and a cast takes several times as long.
bool pass_each_other(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way) {
  const HullFaces* const of_a = hull_faces_of(*a.getCollisionShape());
  const HullFaces* const of_b = hull_faces_of(*b.getCollisionShape());
  if (of_a == nullptr || of_b == nullptr) return false;
  const btTransform& X_A = a.getWorldTransform();
  return stay_apart(*of_a, *of_b, X_A.inverseTimes(b.getWorldTransform()), -(way * X_A.getBasis()));
}

}  // namespace

std::optional<SoftMeeting> meeting_ahead(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way) {
  if (!can_be_cast(a)) {
    if (!can_be_cast(b)) return std::nullopt;
    std::optional<SoftMeeting> turned_round = meeting_ahead(b, a, -way);
    if (turned_round) {
      std::swap(turned_round->r_a, turned_round->r_b);
      std::swap(turned_round->part_a, turned_round->part_b);
      turned_round->normal = -turned_round->normal;
      turned_round->until = -turned_round->until;
    }
    return turned_round;
  }
  if (pass_each_other(a, b, way)) return std::nullopt;
  const btTransform& from = a.getWorldTransform();
  Hit hit(from.getOrigin(), from.getOrigin() + way);
  cast(*a.getCollisionShape(), from, way, b, hit);
  if (!hit.hasHit() || hit.m_closestHitFraction <= 0) return std::nullopt;
  const btVector3 normal = -hit.m_hitNormalWorld.normalized();
  const btVector3 until = way * hit.m_closestHitFraction;
  if (!(until.dot(normal) > 0)) return std::nullopt;
  return SoftMeeting{until,
                     normal,
                     hit.m_hitPointWorld - from.getOrigin() - until,
                     hit.m_hitPointWorld - b.getWorldTransform().getOrigin(),
                     hit.part_of_cast,
                     hit.part_of_target};
}

}  // namespace aurasim::physics
