#include "physics/primitive_contacts.h"

#include <array>
#include <new>
#include <span>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "physics/plane_points.h"
#include "physics/rod_points.h"
#include "physics/whole_manifold.h"

namespace aurasim::physics {
namespace {

bool is_box(const btCollisionObjectWrapper& object) {
  return object.getCollisionShape()->getShapeType() == BOX_SHAPE_PROXYTYPE;
}

bool is_plane(const btCollisionObjectWrapper& object) {
  return object.getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE;
}

btVector3 half_extents_of(const btCollisionObjectWrapper& box) {
  return static_cast<const btBoxShape&>(*box.getCollisionShape()).getHalfExtentsWithMargin();
}

/// A point of the two bodies that a routine calls "one" and "other". `normal` points from the other to the one.
NamedPoint named_point(bool one_is_a, const btVector3& normal, const btVector3& on_other, btScalar gap,
                       ContactFeatures of) {
  if (one_is_a) return {{normal, on_other, gap}, of};
  return {{-normal, on_other + normal * gap, gap}, {of.of_b, of.of_a}};
}

/// Precondition: `object` is a ball or capsule.
Rod rod_of(const btCollisionObjectWrapper& object) {
  return *physics::rod_of(*object.getCollisionShape(), object.getWorldTransform());
}

class PrimitiveContacts final : public WholeContacts {
 public:
  using WholeContacts::WholeContacts;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    Found points;
    const auto found = std::span(points).first(find(*a, *b, points));
    if (give_manifold(*a, *b, !found.empty(), *result)) {
      manifold().put(*a, *b, found, dynamic_cast<CorrectedResult*>(result));
    }
  }

 private:
  using Found = std::array<NamedPoint, MANIFOLD_CACHE_SIZE>;

  /// Writes the points of A and B, and returns their number.
  std::size_t find(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, Found& points) const {
    if (is_plane(a) || is_plane(b)) return is_plane(b) ? on_plane(a, b, true, points) : on_plane(b, a, false, points);
    if (is_box(a) || is_box(b)) return is_box(b) ? on_box(a, b, true, points) : on_box(b, a, false, points);
    const RodPoints found = rod_points(rod_of(a), rod_of(b), manifold().margin_m());
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const RodPoint& point = found.points[i];
      points[i] = named_point(true, point.normal, point.on_other, point.gap, point.features);
    }
    return count;
  }

  std::size_t on_plane(const btCollisionObjectWrapper& round, const btCollisionObjectWrapper& plane, bool round_is_a,
                       Found& points) const {
    const HalfSpace half_space = half_space_of(*plane.getCollisionShape(), plane.getWorldTransform());
    const PlanePoints found = plane_points(rod_of(round), half_space, manifold().margin_m());
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const PlanePoint& point = found.points[i];
      points[i] = named_point(round_is_a, half_space.normal, point.on_plane, point.gap, {point.feature, 0});
    }
    return count;
  }

  /// Looks for the contacts in the frame of the box, so their bits do not depend on which of the two is A.
  std::size_t on_box(const btCollisionObjectWrapper& round, const btCollisionObjectWrapper& box, bool round_is_a,
                     Found& points) const {
    const btTransform& X = box.getWorldTransform();
    Rod rod = rod_of(round);
    rod.centre = X.invXform(rod.centre);
    rod.half = rod.half * X.getBasis();
    const RodPoints found = rod_points(rod, half_extents_of(box), manifold().margin_m());
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const RodPoint& point = found.points[i];
      points[i] = named_point(round_is_a, X.getBasis() * point.normal, X(point.on_other), point.gap, point.features);
    }
    return count;
  }
};

// Bullet's pool has room for its own algorithms.
static_assert(sizeof(PrimitiveContacts) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

btCollisionAlgorithm* PrimitiveContactsMaker::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                       const btCollisionObjectWrapper* a,
                                                                       const btCollisionObjectWrapper* b) {
  void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(PrimitiveContacts));
  return new (memory) PrimitiveContacts(info, *this, *a, *b);
}

}  // namespace aurasim::physics
