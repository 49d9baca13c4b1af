// Bullet's convex hull with its faces, and boxes with theirs. Contacts of two such shapes are those of hull_contacts.h;
// contacts with other shapes are Bullet's, which asks for farthest points of the hull, found here in lanes.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include "physics/hull_faces.h"

namespace aurasim::physics {

/// Gives the same bits as Bullet's hull of the same points. Must not be scaled.
class HullShape final : public btConvexHullShape {
 public:
  HullShape(const btVector3* points, int count);

  /// Sets the faces of the hull with its margin; null if it has no volume. Its bounds are then those of the faces.
  void set_faces(std::unique_ptr<const HullFaces> faces);

  void getAabb(const btTransform& X, btVector3& low, btVector3& high) const override;
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override;
  const char* getName() const override { return "Hull"; }

 private:
  std::array<std::vector<btScalar>, 3> coordinates_;  ///< x, y, z; padded with the first point to full lanes
  std::unique_ptr<const HullFaces> faces_;
};

class BoxShape final : public btBoxShape {
 public:
  explicit BoxShape(const core::Vec3& half_extents);

 private:
  std::unique_ptr<const HullFaces> faces_;
};

}  // namespace aurasim::physics
