#include "physics/hull_contacts.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <span>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/hull_axes.h"
#include "physics/hull_clip.h"
#include "physics/hull_faces.h"

namespace aurasim::physics {
namespace {

const HullFaces& faces_of(const btCollisionObjectWrapper& object) {
  return *hull_faces_of(*object.getCollisionShape());
}

HullFeatures features_of(const btManifoldPoint& point) { return {point.m_partId0, point.m_partId1}; }

class HullContacts final : public btCollisionAlgorithm {
 public:
  HullContacts(const btCollisionAlgorithmConstructionInfo& info, const HullContactsMaker& maker, double margin_m)
      : btCollisionAlgorithm(info), maker_(maker), margin_(margin_m) {}

  ~HullContacts() override {
    if (manifold_ != nullptr) m_dispatcher->releaseManifold(manifold_);
  }

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    const btTransform X_AB = a->getWorldTransform().inverseTimes(b->getWorldTransform());
    const std::optional<HullGap> closest = closest_axis(faces_of(*a), faces_of(*b), X_AB, margin_, last_);
    const bool wants_manifold = closest || maker_.makes_all_manifolds();
    if (manifold_ == nullptr && wants_manifold) {
      manifold_ = m_dispatcher->getNewManifold(a->getCollisionObject(), b->getCollisionObject());
    }
    if (manifold_ == nullptr) return;
    result->setPersistentManifold(manifold_);
    if (closest) {
      put_points(*a, *b, X_AB, *closest);
    } else {
      manifold_->clearManifold();
    }
  }

  /// Not called: fast bodies are stopped by casts.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }

  void getAllContactManifolds(btManifoldArray& manifolds) override {
    if (manifold_ != nullptr) manifolds.push_back(manifold_);
  }

 private:
  void put_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btTransform& X_AB,
                  const HullGap& closest) {
    std::array<btManifoldPoint, MANIFOLD_CACHE_SIZE> before;
    std::array<HullFeatures, MANIFOLD_CACHE_SIZE> features;
    const auto count = static_cast<std::size_t>(manifold_->getNumContacts());
    for (std::size_t i = 0; i < count; ++i) {
      before[i] = manifold_->getContactPoint(static_cast<int>(i));
      features[i] = features_of(before[i]);
    }
    const HullPoints found =
        contact_points(faces_of(a), faces_of(b), X_AB, closest, margin_, std::span(features).first(count));
    manifold_->setNumContacts(found.count);
    for (int i = 0; i < found.count; ++i) {
      const HullPoint& point = found.points[static_cast<std::size_t>(i)];
      btManifoldPoint& to = manifold_->getContactPoint(i);
      to = made_point(a, b, found.normal, point);
      const auto old =
          std::find(features.begin(), features.begin() + static_cast<std::ptrdiff_t>(count), point.features);
      if (old != features.begin() + static_cast<std::ptrdiff_t>(count)) {
        go_on(to, before[static_cast<std::size_t>(old - features.begin())]);
      }
      if (gContactAddedCallback != nullptr && (uses_callback(a) || uses_callback(b))) {
        gContactAddedCallback(to, &a, -1, to.m_index0, &b, -1, to.m_index1);
      }
    }
  }

  static bool uses_callback(const btCollisionObjectWrapper& object) {
    return (object.getCollisionObject()->getCollisionFlags() & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
  }

  static btManifoldPoint made_point(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                                    const btVector3& normal, const HullPoint& point) {
    const btCollisionObject &object_a = *a.getCollisionObject(), &object_b = *b.getCollisionObject();
    const btTransform& X_A = a.getWorldTransform();
    const btVector3 on_a = X_A(point.on_a), on_b = X_A(point.on_b);
    btManifoldPoint made(object_a.getWorldTransform().invXform(on_a), object_b.getWorldTransform().invXform(on_b),
                         -(X_A.getBasis() * normal), point.gap);
    made.m_positionWorldOnA = on_a;
    made.m_positionWorldOnB = on_b;
    made.m_combinedFriction = btManifoldResult::calculateCombinedFriction(&object_a, &object_b);
    made.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(&object_a, &object_b);
    made.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(&object_a, &object_b);
    made.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(&object_a, &object_b);
    made.m_partId0 = point.features.of_a, made.m_partId1 = point.features.of_b;
    made.m_index0 = a.m_index, made.m_index1 = b.m_index;
    made.m_lifeTime = 1;
    return made;
  }

  /// Gives a point what Bullet keeps of a point that it finds again.
  static void go_on(btManifoldPoint& point, const btManifoldPoint& before) {
    point.m_lifeTime = before.m_lifeTime + 1;
    point.m_appliedImpulse = before.m_appliedImpulse;
    point.m_prevRHS = before.m_prevRHS;
    point.m_appliedImpulseLateral1 = before.m_appliedImpulseLateral1;
    point.m_appliedImpulseLateral2 = before.m_appliedImpulseLateral2;
  }

  const HullContactsMaker& maker_;
  const double margin_;
  HullAxis last_;  ///< of this world only: it changes no bit
  btPersistentManifold* manifold_ = nullptr;
};

/// Largest gap of a contact of a body of this size, as Bullet has it.
double margin_of(const btCollisionObjectWrapper& object) {
  return object.getCollisionObject()->getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold);
}

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
  return new (memory) HullContacts(info, *this, std::min({margin_, margin_of(*a), margin_of(*b)}));
}

}  // namespace aurasim::physics
