// The contacts of balls and capsules with each other, with boxes and with planes, also as parts of compounds: all
// points of a manifold at once, in closed form (rod_points.h, plane_points.h). Two balls are left to Bullet, whose
// routine is as good.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

namespace aurasim::physics {

/// Makes the algorithms of pairs of a ball or capsule with a ball, capsule, box or plane.
class PrimitiveContactsMaker final : public btCollisionAlgorithmCreateFunc {
 public:
  /// `margin_m`: largest gap of a contact. Contacts of small bodies have smaller gaps.
  explicit PrimitiveContactsMaker(double margin_m) : margin_(margin_m) {}

  /// While this is set, pairs get a manifold also if they do not touch.
  void make_all_manifolds(bool wanted) { makes_all_manifolds_ = wanted; }
  bool makes_all_manifolds() const { return makes_all_manifolds_; }

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;

 private:
  const double margin_;
  bool makes_all_manifolds_ = false;
};

}  // namespace aurasim::physics
