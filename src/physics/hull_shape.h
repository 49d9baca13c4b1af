// Bullet's convex hull, whose farthest point is looked for in lanes: that is what hulls spend their time on.
#pragma once

#include <array>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

namespace aurasim::physics {

/// Same points, same bits as Bullet's. Not to be scaled.
class HullShape final : public btConvexHullShape {
 public:
  HullShape(const btVector3* points, int count);

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override;
  const char* getName() const override { return "Hull"; }

 private:
  std::array<std::vector<btScalar>, 3> coordinates_;  ///< x, y, z, filled up with the first point
};

}  // namespace aurasim::physics
