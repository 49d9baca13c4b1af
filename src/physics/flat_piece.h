// Convex pieces of statics with flat faces: boxes, hulls, half-spaces, and the triangles of meshes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <LinearMath/btTransform.h>

class btCollisionObject;
class btCollisionShape;

namespace aurasim::physics {

/// A half-space that holds a piece: normal . x <= offset_m, in the world frame.
struct FlatFace {
  btVector3 normal;
  btScalar offset_m;
  bool is_surface;              ///< false: the border of a triangle, which nothing lies on
  bool may_be_covered = false;  ///< another piece may lie in front of it

  btScalar above(const btVector3& p) const { return normal.dot(p) - offset_m; }
};

/// A convex piece: what all of its faces hold.
struct FlatPiece {
  const btCollisionObject* object = nullptr;
  int index = -1;         ///< child of a compound, or triangle of a mesh; -1: the object itself
  btScalar margin_m = 0;  ///< by which Bullet rounds its edges
  bool is_triangle = false;
  std::span<const FlatFace> faces;  ///< of a triangle: upper side, lower side, three borders

  bool is(const FlatPiece& other) const { return object == other.object && index == other.index; }
  /// True if p is in the piece, or at most so far from each of its faces, m. `but`: a face that does not count.
  bool holds(const btVector3& p, btScalar within_m, const FlatFace* but = nullptr) const {
    for (const FlatFace& face : faces) {
      if (&face != but && face.above(p) > within_m) return false;
    }
    return true;
  }
  /// Like holds(p). A triangle holds what is up to 1 cm below it, because there is ground behind it.
  bool covers(const btVector3& p, btScalar within_m) const;
};

/// The faces of a triangle. `corners` are in the world, counter-clockwise from above. All 0 if it has no area.
std::array<FlatFace, 5> faces_of_triangle(const btVector3 (&corners)[3]);

/// The faces of a shape at a pose; empty if it is not flat everywhere.
std::vector<FlatFace> faces_of(const btCollisionShape& shape, const btTransform& pose);

/// True if a piece rises above the plane through a point of its surface across `direction`: the direction is then
/// outside of the normals that the faces there allow. Faces count that are at most `within_m` from the point.
bool rises_above(const FlatPiece& piece, const btVector3& p, const btVector3& direction, btScalar within_m);

}  // namespace aurasim::physics
