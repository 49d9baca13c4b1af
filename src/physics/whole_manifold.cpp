#include "physics/whole_manifold.h"

#include <algorithm>
#include <optional>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

namespace aurasim::physics {
namespace {

double margin_of(const btCollisionObjectWrapper& object) {
  return object.getCollisionObject()->getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold);
}

/// Largest gap of a contact of these two, m: at most `most_m`, and less for small bodies, as Bullet has it.
double contact_margin(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, double most_m) {
  return std::min({most_m, margin_of(a), margin_of(b)});
}

ContactFeatures features_of(const btManifoldPoint& point) { return {point.m_partId0, point.m_partId1}; }

bool uses_callback(const btCollisionObjectWrapper& object) {
  return (object.getCollisionObject()->getCollisionFlags() & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
}

btManifoldPoint made_point(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const PointOnB& where,
                           ContactFeatures features) {
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

/// The part of a point that Bullet keeps when it finds the point again.
struct Kept {
  explicit Kept(const btManifoldPoint& point)
      : features(features_of(point)),
        life_time(point.m_lifeTime),
        impulse(point.m_appliedImpulse),
        rhs(point.m_prevRHS),
        lateral_1(point.m_appliedImpulseLateral1),
        lateral_2(point.m_appliedImpulseLateral2) {}

  void give(btManifoldPoint& point) const {
    point.m_lifeTime = life_time + 1;
    point.m_appliedImpulse = impulse;
    point.m_prevRHS = rhs;
    point.m_appliedImpulseLateral1 = lateral_1;
    point.m_appliedImpulseLateral2 = lateral_2;
  }

  ContactFeatures features;
  int life_time;
  btScalar impulse, rhs, lateral_1, lateral_2;
};

}  // namespace

WholeManifold::~WholeManifold() {
  if (manifold_ != nullptr) dispatcher_.releaseManifold(manifold_);
}

void WholeManifold::make(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
  if (manifold_ == nullptr) manifold_ = dispatcher_.getNewManifold(a.getCollisionObject(), b.getCollisionObject());
}

std::span<const ContactFeatures> WholeManifold::features(FeatureSpace& space) const {
  const auto count = static_cast<std::size_t>(manifold_->getNumContacts());
  for (std::size_t i = 0; i < count; ++i) space[i] = features_of(manifold_->getContactPoint(static_cast<int>(i)));
  return std::span(space).first(count);
}

void WholeManifold::put(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                        std::span<const NamedPoint> points, CorrectedResult* inner_edges) {
  std::array<std::optional<Kept>, MANIFOLD_CACHE_SIZE> before;
  for (int i = 0; i < manifold_->getNumContacts(); ++i) {
    before[static_cast<std::size_t>(i)].emplace(manifold_->getContactPoint(i));
  }
  manifold_->setNumContacts(0);
  for (const NamedPoint& point : points) {
    PointOnB where = point.where;
    if (inner_edges != nullptr) {
      const std::optional<PointOnB> corrected = inner_edges->corrected(a, b, where);
      if (!corrected) continue;
      // several points on an inner edge can be moved to one place
      const bool was_moved = corrected->on_b.distance2(where.on_b) != 0;
      if (was_moved && has_near(corrected->on_b)) continue;
      where = *corrected;
    }
    const int place = manifold_->getNumContacts();
    manifold_->setNumContacts(place + 1);
    btManifoldPoint& to = manifold_->getContactPoint(place);
    to = made_point(a, b, where, point.features);
    for (const std::optional<Kept>& kept : before) {
      if (!kept || kept->features != point.features) continue;
      kept->give(to);
      break;
    }
    if (gContactAddedCallback != nullptr && (uses_callback(a) || uses_callback(b))) {
      gContactAddedCallback(to, &a, -1, to.m_index0, &b, -1, to.m_index1);
    }
  }
}

/// True if the manifold has a point near a place.
bool WholeManifold::has_near(const btVector3& on_b) const {
  const btScalar near2 = static_cast<btScalar>(margin_ * margin_);
  for (int i = 0; i < manifold_->getNumContacts(); ++i) {
    if (manifold_->getContactPoint(i).m_positionWorldOnB.distance2(on_b) < near2) return true;
  }
  return false;
}

WholeContacts::WholeContacts(const btCollisionAlgorithmConstructionInfo& info, const WholeContactsMaker& maker,
                             const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b)
    : btCollisionAlgorithm(info),
      maker_(maker),
      manifold_(*info.m_dispatcher1, contact_margin(a, b, maker.margin_m())) {}

void WholeContacts::getAllContactManifolds(btManifoldArray& manifolds) {
  if (manifold_.get() != nullptr) manifolds.push_back(manifold_.get());
}

bool WholeContacts::give_manifold(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, bool touches,
                                  btManifoldResult& result) {
  if (touches || maker_.makes_all_manifolds()) manifold_.make(a, b);
  if (manifold_.get() == nullptr) return false;
  result.setPersistentManifold(manifold_.get());
  if (!touches) manifold_.get()->clearManifold();
  return touches;
}

}  // namespace aurasim::physics
