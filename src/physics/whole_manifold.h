// The manifold of a pair of shapes whose contact points are all found at once from the two poses (hull_contacts.h,
// primitive_contacts.h).
//
// A point is named by features of the two shapes, in the fields m_partId0 and m_partId1, which Bullet uses for meshes
// only. A point with the features of one of the last step goes on with its impulses.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/contact_features.h"
#include "physics/corrected_result.h"

class btCollisionObjectWrapper;
class btDispatcher;

namespace aurasim::physics {

struct NamedPoint {
  PointOnB where;
  ContactFeatures features;
};

class WholeManifold {
 public:
  /// `margin_m`: largest gap of a contact of the pair. `dispatcher` has to outlive the manifold.
  WholeManifold(btDispatcher& dispatcher, double margin_m) : dispatcher_(dispatcher), margin_(margin_m) {}
  ~WholeManifold();
  WholeManifold(const WholeManifold&) = delete;
  WholeManifold& operator=(const WholeManifold&) = delete;

  double margin_m() const { return margin_; }
  /// Null until make().
  btPersistentManifold* get() const { return manifold_; }
  void make(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b);

  /// The features of the present points. `space` holds them. Precondition: made.
  using FeatureSpace = std::array<ContactFeatures, MANIFOLD_CACHE_SIZE>;
  std::span<const ContactFeatures> features(FeatureSpace& space) const;

  /// Replaces the points. `inner_edges` corrects those with a static; may be null. Precondition: made.
  void put(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, std::span<const NamedPoint> points,
           CorrectedResult* inner_edges);

 private:
  bool has_near(const btVector3& on_b) const;

  btDispatcher& dispatcher_;
  const double margin_;
  btPersistentManifold* manifold_ = nullptr;
};

/// Makes the algorithms of pairs whose points are all found at once.
class WholeContactsMaker : public btCollisionAlgorithmCreateFunc {
 public:
  /// `margin_m`: largest gap of a contact. Contacts of small bodies have smaller gaps.
  explicit WholeContactsMaker(double margin_m) : margin_(margin_m) {}

  /// While this is set, pairs get a manifold also if they do not touch.
  void make_all_manifolds(bool wanted) { makes_all_manifolds_ = wanted; }
  bool makes_all_manifolds() const { return makes_all_manifolds_; }
  double margin_m() const { return margin_; }

 private:
  const double margin_;
  bool makes_all_manifolds_ = false;
};

/// The algorithm of one such pair, but for how the points are found.
class WholeContacts : public btCollisionAlgorithm {
 public:
  /// `maker` has to outlive the algorithm.
  WholeContacts(const btCollisionAlgorithmConstructionInfo& info, const WholeContactsMaker& maker,
                const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b);

  /// Not called: fast bodies are stopped by casts.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 protected:
  const WholeManifold& manifold() const { return manifold_; }
  WholeManifold& manifold() { return manifold_; }
  /// Gives the pair's manifold, if there is one, to `result`. Returns `touches`; if that is false the manifold is
  /// emptied, else it is there, and the caller puts the points.
  bool give_manifold(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, bool touches,
                     btManifoldResult& result);

 private:
  const WholeContactsMaker& maker_;
  WholeManifold manifold_;
};

}  // namespace aurasim::physics
