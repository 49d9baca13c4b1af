// Bullet's convex hull with a vectorised search for the farthest point, on which hulls spend most of their time.
#pragma once

#include <array>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

namespace aurasim::physics {

/// Gives the same bits as Bullet's hull of the same points. Must not be scaled.
class HullShape final : public btConvexHullShape {
 public:
  HullShape(const btVector3* points, int count);

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override;
  const char* getName() const override { return "Hull"; }

 private:
  std::array<std::vector<btScalar>, 3> coordinates_;  ///< x, y, z; padded with the first point to full lanes
};

}  // namespace aurasim::physics
