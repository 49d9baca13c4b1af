#include "physics/hull_contacts.h"

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

#include "physics/hull_axes.h"
#include "physics/hull_clip.h"
#include "physics/hull_faces.h"
#include "physics/whole_manifold.h"

namespace aurasim::physics {
namespace {

const HullFaces& faces_of(const btCollisionObjectWrapper& object) {
  return *hull_faces_of(*object.getCollisionShape());
}

class HullContacts final : public btCollisionAlgorithm {
 public:
  HullContacts(const btCollisionAlgorithmConstructionInfo& info, const HullContactsMaker& maker, double margin_m)
      : btCollisionAlgorithm(info), maker_(maker), manifold_(*info.m_dispatcher1, margin_m) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    const btTransform X_AB = a->getWorldTransform().inverseTimes(b->getWorldTransform());
    const std::optional<HullGap> closest = closest_axis(faces_of(*a), faces_of(*b), X_AB, manifold_.margin_m(), last_);
    if (closest || maker_.makes_all_manifolds()) manifold_.make(*a, *b);
    if (manifold_.get() == nullptr) return;
    result->setPersistentManifold(manifold_.get());
    if (closest) {
      put_points(*a, *b, X_AB, *closest, dynamic_cast<CorrectedResult*>(result));
    } else {
      manifold_.get()->clearManifold();
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
  void put_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btTransform& X_AB,
                  const HullGap& closest, CorrectedResult* inner_edges) {
    WholeManifold::FeatureSpace before;
    const HullPoints found =
        contact_points(faces_of(a), faces_of(b), X_AB, closest, manifold_.margin_m(), manifold_.features(before));
    std::array<NamedPoint, std::tuple_size_v<decltype(found.points)>> points;
    const btTransform& X_A = a.getWorldTransform();
    const btVector3 normal = -(X_A.getBasis() * found.normal);
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const HullPoint& point = found.points[i];
      points[i] = {{normal, X_A(point.on_b), point.gap}, point.features};
    }
    manifold_.put(a, b, std::span(points).first(count), inner_edges);
  }

  const HullContactsMaker& maker_;
  HullAxis last_;  ///< of this world only: it changes no bit
  WholeManifold manifold_;
};

// Bullet's pool has room for its own algorithms.
static_assert(sizeof(HullContacts) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

btCollisionAlgorithm* HullContactsMaker::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                  const btCollisionObjectWrapper* a,
                                                                  const btCollisionObjectWrapper* b) {
  if (hull_faces_of(*a->getCollisionShape()) == nullptr || hull_faces_of(*b->getCollisionShape()) == nullptr) {
    return others_.CreateCollisionAlgorithm(info, a, b);
  }
  void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(HullContacts));
  return new (memory) HullContacts(info, *this, contact_margin(*a, *b, margin_));
}

}  // namespace aurasim::physics
