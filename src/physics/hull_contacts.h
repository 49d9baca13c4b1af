// The contacts of two hulls or boxes, also as parts of compounds: all points of a manifold at once, from the two poses.
// Bullet's own algorithm finds one point a step, and puts others beside it that it found in earlier steps.
#pragma once

#include "physics/whole_manifold.h"

namespace aurasim::physics {

/// Makes the algorithms of pairs in which both shapes have faces (hull_faces.h); those of others by `others`.
class HullContactsMaker final : public WholeContactsMaker {
 public:
  HullContactsMaker(btCollisionAlgorithmCreateFunc& others, double margin_m)
      : WholeContactsMaker(margin_m), others_(others) {}

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;

 private:
  btCollisionAlgorithmCreateFunc& others_;
};

}  // namespace aurasim::physics
