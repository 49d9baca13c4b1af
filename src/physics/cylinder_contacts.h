// The contacts of cylinders with each other, with boxes, hulls, planes and triangles of meshes, also as parts of
// compounds: all points of a manifold at once (cylinder_points.h, two_cylinders.h). Where neither a face nor a cap nor
// the barrel gives the normal, at edges and corners, it is found by Bullet's search (GJK).
#pragma once

#include "physics/whole_manifold.h"

namespace aurasim::physics {

/// Makes the algorithms of pairs of a cylinder with a cylinder, box, hull, plane or triangle; those of hulls without
/// volume by `others`.
class CylinderContactsMaker final : public WholeContactsMaker {
 public:
  CylinderContactsMaker(btCollisionAlgorithmCreateFunc& others, double margin_m)
      : WholeContactsMaker(margin_m), others_(others) {}

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override;

 private:
  btCollisionAlgorithmCreateFunc& others_;
};

}  // namespace aurasim::physics
