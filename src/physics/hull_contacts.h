// The contacts of two hulls or boxes, also as parts of compounds: all points of a manifold at once, from the two poses.
// Bullet's own algorithm finds one point a step, and puts others beside it that it found in earlier steps.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

namespace aurasim::physics {

/// Makes the algorithms of pairs in which both shapes have faces (hull_faces.h); those of others by `others`.
class HullContactsMaker final : public btCollisionAlgorithmCreateFunc {
 public:
  /// `margin_m`: largest gap of a contact. Contacts of small bodies have smaller gaps.
  HullContactsMaker(btCollisionAlgorithmCreateFunc& others, double margin_m) : others_(others), margin_(margin_m) {}

  /// While this is set, pairs get a manifold also if they do not touch.
  void make_all_manifolds(bool wanted) { makes_all_manifolds_ = wanted; }
  bool makes_all_manifolds() const { return makes_all_manifolds_; }

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;

 private:
  btCollisionAlgorithmCreateFunc& others_;
  const double margin_;
  bool makes_all_manifolds_ = false;
};

}  // namespace aurasim::physics
