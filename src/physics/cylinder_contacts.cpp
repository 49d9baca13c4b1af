#include "physics/cylinder_contacts.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <span>
#include <tuple>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "physics/cylinder_faces.h"
#include "physics/hull_faces.h"
#include "physics/rod_points.h"
#include "physics/two_cylinders.h"

namespace aurasim::physics {
namespace {

/// Normals with a smaller product with the axis are those of a barrel.
constexpr btScalar kAcross = btScalar(0.02);

bool is_cylinder(const btCollisionObjectWrapper& object) {
  return object.getCollisionShape()->getShapeType() == CYLINDER_SHAPE_PROXYTYPE;
}

/// Precondition: a cylinder along z (shapes.cpp). `X`: its pose in the frame of the other body.
Cylinder cylinder_of(const btCollisionShape& shape, const btTransform& X) {
  const btVector3 half = static_cast<const btCylinderShape&>(shape).getHalfExtentsWithMargin();
  const btMatrix3x3& R = X.getBasis();
  return {X.getOrigin(), R.getColumn(2), R.getColumn(0), R.getColumn(1), half.z(), half.x()};
}

HalfSpace half_space_in_frame(const btCollisionShape& shape) {
  const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
  return {plane.getPlaneNormal(), plane.getPlaneConstant()};
}

/// The normal of a barrel with a box is that of the rod within the cylinder, so it is known in closed form. Elsewhere
/// it is Bullet's search. Everything is in the frame of the other shape.
class CylinderSearch final : public NearestPoints {
 public:
  /// Keeps references. `X`: pose of the cylinder in the frame of the other shape.
  CylinderSearch(const btCollisionShape& cylinder, const btTransform& X, const btCollisionShape& other, double margin_m)
      : cylinder_(static_cast<const btConvexShape&>(cylinder)),
        other_(static_cast<const btConvexShape&>(other)),
        X_(X),
        margin_(static_cast<btScalar>(margin_m)) {}

  std::optional<SearchedPoint> find() const override {
    if (const std::optional<SearchedPoint> of_barrel = nearest_of_barrel()) return of_barrel;
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver depth;
    btGjkPairDetector detector(&cylinder_, &other_, &simplex, &depth);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = X_;
    input.m_transformB.setIdentity();
    const btScalar most = cylinder_.getMargin() + other_.getMargin() + margin_;
    input.m_maximumDistanceSquared = most * most;
    btPointCollector found;
    detector.getClosestPoints(input, found, nullptr);
    if (!found.m_hasResult || !(found.m_distance <= margin_)) return std::nullopt;
    return SearchedPoint{found.m_normalOnBInWorld, found.m_pointInWorld, found.m_distance};
  }

 private:
  std::optional<SearchedPoint> nearest_of_barrel() const {
    if (other_.getShapeType() != BOX_SHAPE_PROXYTYPE) return std::nullopt;
    const Cylinder placed = cylinder_of(cylinder_, X_);
    const RodPoints found = rod_points({placed.centre, placed.axis * placed.half_height, placed.radius},
                                       static_cast<const btBoxShape&>(other_).getHalfExtentsWithMargin(), margin_);
    const auto points = std::span(found.points).first(static_cast<std::size_t>(found.count));
    const auto deepest = std::ranges::min_element(points, {}, &RodPoint::gap);
    if (deepest == points.end() || btFabs(deepest->normal.dot(placed.axis)) > kAcross) return std::nullopt;
    return SearchedPoint{deepest->normal, deepest->on_other, deepest->gap};
  }

  const btConvexShape &cylinder_, &other_;
  const btTransform& X_;
  const btScalar margin_;
};

class CylinderContacts final : public WholeContacts {
 public:
  using WholeContacts::WholeContacts;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    const bool cylinder_is_a = is_cylinder(*a);
    const btCollisionObjectWrapper &cylinder = cylinder_is_a ? *a : *b, &other = cylinder_is_a ? *b : *a;
    const HullPoints found = find(cylinder, other, cylinder_is_a);
    if (!give_manifold(*a, *b, found.count > 0, *result)) return;
    std::array<NamedPoint, std::tuple_size_v<decltype(found.points)>> points;
    const btTransform& X = other.getWorldTransform();
    const btVector3 up = -(X.getBasis() * found.normal);
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const HullPoint& point = found.points[i];
      const auto [of_cylinder, of_other] = point.features;
      points[i] = cylinder_is_a ? NamedPoint{{up, X(point.on_b), point.gap}, {of_cylinder, of_other}}
                                : NamedPoint{{-up, X(point.on_a), point.gap}, {of_other, of_cylinder}};
    }
    manifold().put(*a, *b, std::span(points).first(count), dynamic_cast<CorrectedResult*>(result));
  }

 private:
  HullPoints find(const btCollisionObjectWrapper& cylinder, const btCollisionObjectWrapper& other,
                  bool cylinder_is_a) const {
    const btTransform X = other.getWorldTransform().inverseTimes(cylinder.getWorldTransform());
    const btCollisionShape &shape = *cylinder.getCollisionShape(), &of_other = *other.getCollisionShape();
    const Cylinder placed = cylinder_of(shape, X);
    const double margin = manifold().margin_m();
    if (of_other.getShapeType() == STATIC_PLANE_PROXYTYPE) {
      return cylinder_contact(placed, half_space_in_frame(of_other), margin);
    }
    if (is_cylinder(other)) return with_cylinder(placed, other, CylinderSearch(shape, X, of_other, margin));
    WholeManifold::FeatureSpace space;
    std::span<ContactFeatures> before;
    if (manifold().get() != nullptr) {
      before = std::span(space).first(manifold().features(space).size());
      if (!cylinder_is_a) {
        for (ContactFeatures& one : before) std::swap(one.of_a, one.of_b);
      }
    }
    return cylinder_contact(placed, *hull_faces_of(of_other), margin, before,
                            CylinderSearch(shape, X, of_other, margin));
  }

  HullPoints with_cylinder(const Cylinder& cylinder, const btCollisionObjectWrapper& other,
                           const CylinderSearch& search) const {
    const Cylinder second = cylinder_of(*other.getCollisionShape(), btTransform::getIdentity());
    if (const auto found = cylinder_contact(cylinder, second, manifold().margin_m())) return *found;
    const std::optional<SearchedPoint> found = search.find();
    return found ? searched_contact(cylinder, second, *found, manifold().margin_m()) : HullPoints{};
  }
};

/// Bullet has one manifold for all triangles of a mesh, and makes an algorithm for each triangle that is near. The
/// cylinder is the first body.
class OnTriangle final : public btCollisionAlgorithm {
 public:
  explicit OnTriangle(const btCollisionAlgorithmConstructionInfo& info) : btCollisionAlgorithm(info) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    const btTransform& X_B = b->getWorldTransform();
    const btTransform X = X_B.inverseTimes(a->getWorldTransform());
    const btCollisionShape &shape = *a->getCollisionShape(), &triangle = *b->getCollisionShape();
    const double margin_m = result->getPersistentManifold()->getContactBreakingThreshold();
    const HullPoints found =
        cylinder_contact(cylinder_of(shape, X), static_cast<const btTriangleShape&>(triangle).m_vertices1, margin_m,
                         CylinderSearch(shape, X, triangle, margin_m));
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      result->addContactPoint(-(X_B.getBasis() * found.normal), X_B(found.points[i].on_b),
                              static_cast<btScalar>(found.points[i].gap));
    }
  }
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray&) override {}
};

// Bullet's pool has room for its own algorithms.
static_assert(sizeof(CylinderContacts) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

btCollisionAlgorithm* CylinderContactsMaker::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                      const btCollisionObjectWrapper* a,
                                                                      const btCollisionObjectWrapper* b) {
  const btCollisionObjectWrapper& other = is_cylinder(*a) ? *b : *a;
  const int kind = other.getCollisionShape()->getShapeType();
  const bool has_outline = kind == STATIC_PLANE_PROXYTYPE || kind == CYLINDER_SHAPE_PROXYTYPE ||
                           hull_faces_of(*other.getCollisionShape()) != nullptr;
  if (kind == TRIANGLE_SHAPE_PROXYTYPE) {
    return new (info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(OnTriangle))) OnTriangle(info);
  }
  if (!has_outline) return others_.CreateCollisionAlgorithm(info, a, b);
  return new (info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(CylinderContacts)))
      CylinderContacts(info, *this, *a, *b);
}

}  // namespace aurasim::physics
