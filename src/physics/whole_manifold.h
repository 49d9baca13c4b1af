// The manifold of a pair of shapes whose contact points are all found at once from the two poses (hull_contacts.h,
// primitive_contacts.h).
//
// A point is named by features of the two shapes, in the fields m_partId0 and m_partId1, which Bullet uses for meshes
// only. A point with the features of one of the last step goes on with its impulses.
#pragma once

#include <array>
#include <cstddef>
#include <span>

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

/// Largest gap of a contact of these two, m: at most `most_m`, and less for small bodies, as Bullet has it.
double contact_margin(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, double most_m);

class WholeManifold {
 public:
  /// `margin_m`: as contact_margin() gives it. `dispatcher` has to outlive the manifold.
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

}  // namespace aurasim::physics
