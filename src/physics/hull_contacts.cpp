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

#include "physics/corrected_result.h"
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
      put_points(*a, *b, X_AB, *closest, dynamic_cast<CorrectedResult*>(result));
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
  /// `inner_edges` corrects the points with a static; may be null.
  void put_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btTransform& X_AB,
                  const HullGap& closest, CorrectedResult* inner_edges) {
    std::array<btManifoldPoint, MANIFOLD_CACHE_SIZE> before;
    std::array<HullFeatures, MANIFOLD_CACHE_SIZE> features;
    const auto count = static_cast<std::size_t>(manifold_->getNumContacts());
    for (std::size_t i = 0; i < count; ++i) {
      before[i] = manifold_->getContactPoint(static_cast<int>(i));
      features[i] = features_of(before[i]);
    }
    const HullPoints found =
        contact_points(faces_of(a), faces_of(b), X_AB, closest, margin_, std::span(features).first(count));
    manifold_->setNumContacts(0);
    for (int i = 0; i < found.count; ++i) {
      const HullPoint& point = found.points[static_cast<std::size_t>(i)];
      const btTransform& X_A = a.getWorldTransform();
      PointOnB where{-(X_A.getBasis() * found.normal), X_A(point.on_b), point.gap};
      if (inner_edges != nullptr) {
        const std::optional<PointOnB> corrected = inner_edges->corrected(a, b, where);
        if (!corrected || is_there(corrected->on_b, where)) continue;
        where = *corrected;
      }
      const int place = manifold_->getNumContacts();
      manifold_->setNumContacts(place + 1);
      btManifoldPoint& to = manifold_->getContactPoint(place);
      to = made_point(a, b, where, point.features);
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

  /// True if a point was moved to `on_b`, where the pair has one already. Several points on an inner edge can be moved
  /// to one place.
  bool is_there(const btVector3& on_b, const PointOnB& found) const {
    const btScalar near2 = static_cast<btScalar>(margin_ * margin_);
    if (on_b.distance2(found.on_b) == 0) return false;
    for (int i = 0; i < manifold_->getNumContacts(); ++i) {
      if (manifold_->getContactPoint(i).m_positionWorldOnB.distance2(on_b) < near2) return true;
    }
    return false;
  }

  static bool uses_callback(const btCollisionObjectWrapper& object) {
    return (object.getCollisionObject()->getCollisionFlags() & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
  }

  static btManifoldPoint made_point(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                                    const PointOnB& where, HullFeatures features) {
    const btCollisionObject &object_a = *a.getCollisionObject(), &object_b = *b.getCollisionObject();
    const btVector3 on_a = where.on_b + where.normal * where.gap_m;
    btManifoldPoint made(object_a.getWorldTransform().invXform(on_a), object_b.getWorldTransform().invXform(where.on_b),
                         where.normal, where.gap_m);
    made.m_positionWorldOnA = on_a;
    made.m_positionWorldOnB = where.on_b;
    made.m_combinedFriction = btManifoldResult::calculateCombinedFriction(&object_a, &object_b);
    made.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(&object_a, &object_b);
    made.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(&object_a, &object_b);
    made.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(&object_a, &object_b);
    made.m_partId0 = features.of_a, made.m_partId1 = features.of_b;
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
