#include "physics/soft/ahead.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "physics/hull_axes.h"
#include "physics/hull_faces.h"
#include "physics/plane_points.h"
#include "physics/rod_points.h"

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

/// Bodies that stay farther apart than this, m, are no hit of a cast, which takes 1 mm for a touch.
constexpr btScalar kApart_m = btScalar(0.002);

/// True if the gap along one direction shows that two shapes do not touch while one of them moves by `way`. The normal
/// points to the one that moves.
bool stays_beyond(btScalar gap, const btVector3& normal, const btVector3& way) {
  return gap + std::min(btScalar(0), normal.dot(way)) > kApart_m;
}

bool passes_plane(const btCollisionObject& a, const btCollisionObject& plane, const btVector3& way) {
  if (!a.getCollisionShape()->isConvex()) return false;
  const HalfSpace half_space = half_space_of(*plane.getCollisionShape(), plane.getWorldTransform());
  const btTransform& X = a.getWorldTransform();
  const btVector3 lowest = X(static_cast<const btConvexShape*>(a.getCollisionShape())
                                 ->localGetSupportingVertex(-half_space.normal * X.getBasis()));
  return stays_beyond(half_space.above(lowest), half_space.normal, way);
}

bool passes_box(const Rod& a, const btCollisionObject& box, const btVector3& way) {
  const btTransform& X = box.getWorldTransform();
  const Rod in_box{X.invXform(a.centre), a.half * X.getBasis(), a.radius};
  const std::optional<RodPoint> nearest =
      nearest_point(in_box, static_cast<const btBoxShape&>(*box.getCollisionShape()).getHalfExtentsWithMargin());
  return nearest && stays_beyond(nearest->gap, nearest->normal, way * X.getBasis());
}

/// True if a plain test shows that two bodies pass each other. Those are most of the bodies that might meet, and a cast
/// takes several times as long.
bool pass_each_other(const btCollisionObject& a, const btCollisionObject& b, const btVector3& way) {
  const btCollisionShape &of_a = *a.getCollisionShape(), &of_b = *b.getCollisionShape();
  if (of_b.getShapeType() == STATIC_PLANE_PROXYTYPE) return passes_plane(a, b, way);
  const HullFaces *const faces_a = hull_faces_of(of_a), *const faces_b = hull_faces_of(of_b);
  const btTransform& X_A = a.getWorldTransform();
  if (faces_a != nullptr && faces_b != nullptr) {
    return stay_apart(*faces_a, *faces_b, X_A.inverseTimes(b.getWorldTransform()), -(way * X_A.getBasis()));
  }
  const std::optional<Rod> rod_a = rod_of(of_a, X_A), rod_b = rod_of(of_b, b.getWorldTransform());
  if (rod_a && rod_b) {
    const RodPoint nearest = nearest_point(*rod_a, *rod_b);
    return stays_beyond(nearest.gap, nearest.normal, way);
  }
  if (rod_a && of_b.getShapeType() == BOX_SHAPE_PROXYTYPE) return passes_box(*rod_a, b, way);
  return rod_b && of_a.getShapeType() == BOX_SHAPE_PROXYTYPE && passes_box(*rod_b, a, -way);
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
