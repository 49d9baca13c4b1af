// Receives the contact points of a pair with a static from Bullet, and corrects those with inner edges (inner_edges.h).
#pragma once

#include <optional>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "physics/inner_edges.h"

namespace aurasim::physics {

/// A contact point of two bodies A and B.
struct PointOnB {
  btVector3 normal;  ///< from B to A
  btVector3 on_b;    ///< m, world
  btScalar gap_m;
};

class CorrectedResult : public btManifoldResult {
 public:
  /// Keeps references to all of them.
  CorrectedResult(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const InnerEdges& inner_edges)
      : btManifoldResult(&a, &b), inner_edges_(inner_edges) {}

  void addContactPoint(const btVector3& normal, const btVector3& on_b, btScalar gap_m) override;
  /// The point as it should be; nothing if it is to be left out. One of `a` and `b` is a static.
  std::optional<PointOnB> corrected(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                                    const PointOnB& found);
  bool has_left_out() const { return has_left_out_; }

 private:
  const InnerEdges& inner_edges_;
  bool has_left_out_ = false;
};

}  // namespace aurasim::physics
