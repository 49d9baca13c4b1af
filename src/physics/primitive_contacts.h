// The contacts of balls and capsules with each other, with boxes and with planes, also as parts of compounds: all
// points of a manifold at once, in closed form (rod_points.h, plane_points.h). Two balls are left to Bullet, whose
// routine is as good.
#pragma once

#include "physics/whole_manifold.h"

namespace aurasim::physics {

/// Makes the algorithms of pairs of a ball or capsule with a ball, capsule, box or plane.
class PrimitiveContactsMaker final : public WholeContactsMaker {
 public:
  using WholeContactsMaker::WholeContactsMaker;

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;
};

}  // namespace aurasim::physics
