#include "physics/round_contacts.h"

#include <array>
#include <new>
#include <span>
#include <utility>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "physics/rod_points.h"
#include "physics/whole_manifold.h"

namespace aurasim::physics {
namespace {

bool is_box(const btCollisionObjectWrapper& object) {
  return object.getCollisionShape()->getShapeType() == BOX_SHAPE_PROXYTYPE;
}

/// A ball or capsule in the world.
Rod rod_of(const btCollisionObjectWrapper& object) {
  const btCollisionShape& shape = *object.getCollisionShape();
  const btTransform& pose = object.getWorldTransform();
  if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
    return {pose.getOrigin(), {0, 0, 0}, static_cast<const btSphereShape&>(shape).getRadius()};
  }
  const auto& capsule = static_cast<const btCapsuleShape&>(shape);
  return {pose.getOrigin(), pose.getBasis().getColumn(capsule.getUpAxis()) * capsule.getHalfHeight(),
          capsule.getRadius()};
}

class RoundContacts final : public btCollisionAlgorithm {
 public:
  RoundContacts(const btCollisionAlgorithmConstructionInfo& info, const RoundContactsMaker& maker, double margin_m)
      : btCollisionAlgorithm(info), maker_(maker), manifold_(*info.m_dispatcher1, margin_m) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    std::array<NamedPoint, std::tuple_size_v<decltype(RodPoints::points)>> points;
    const auto found = std::span(points).first(find(*a, *b, points));
    if (!found.empty() || maker_.makes_all_manifolds()) manifold_.make(*a, *b);
    if (manifold_.get() == nullptr) return;
    result->setPersistentManifold(manifold_.get());
    if (found.empty()) {
      manifold_.get()->clearManifold();
    } else {
      manifold_.put(*a, *b, found, dynamic_cast<CorrectedResult*>(result));
    }
  }

  /// Not called: fast bodies are stopped by casts.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }

  void getAllContactManifolds(btManifoldArray& manifolds) override {
    if (manifold_.get() != nullptr) manifolds.push_back(manifold_.get());
  }

 private:
  /// Writes the points of A and B, and returns their number.
  std::size_t find(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                   std::span<NamedPoint> points) const {
    if (is_box(b)) return find_on_box(a, b, false, points);
    if (is_box(a)) return find_on_box(b, a, true, points);
    const RodPoints found = rod_points(rod_of(a), rod_of(b), manifold_.margin_m());
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const RodPoint& point = found.points[i];
      points[i] = {{point.normal, point.on_other, point.gap}, point.features};
    }
    return count;
  }

  /// Looks for the contacts in the frame of the box, so their bits do not depend on which of the two is A.
  std::size_t find_on_box(const btCollisionObjectWrapper& round, const btCollisionObjectWrapper& box, bool box_is_a,
                          std::span<NamedPoint> points) const {
    const btTransform& X = box.getWorldTransform();
    Rod rod = rod_of(round);
    rod.centre = X.invXform(rod.centre);
    rod.half = rod.half * X.getBasis();
    const auto& shape = static_cast<const btBoxShape&>(*box.getCollisionShape());
    const RodPoints found = rod_points(rod, shape.getHalfExtentsWithMargin(), manifold_.margin_m());
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const RodPoint& point = found.points[i];
      const btVector3 normal = X.getBasis() * point.normal, on_box = X(point.on_other);
      const ContactFeatures &of = point.features;
      points[i] = box_is_a ? NamedPoint{{-normal, on_box + normal * point.gap, point.gap}, {of.of_b, of.of_a}}
                           : NamedPoint{{normal, on_box, point.gap}, of};
    }
    return count;
  }

  const RoundContactsMaker& maker_;
  WholeManifold manifold_;
};

// Bullet's pool has room for its own algorithms.
static_assert(sizeof(RoundContacts) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

btCollisionAlgorithm* RoundContactsMaker::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                   const btCollisionObjectWrapper* a,
                                                                   const btCollisionObjectWrapper* b) {
  void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(RoundContacts));
  return new (memory) RoundContacts(info, *this, contact_margin(*a, *b, margin_));
}

}  // namespace aurasim::physics
