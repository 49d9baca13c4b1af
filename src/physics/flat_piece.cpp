#include "physics/flat_piece.h"

#include <algorithm>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include "physics/hull_faces.h"

namespace aurasim::physics {
namespace {

constexpr btScalar kGround_m = btScalar(0.01);
/// Sine of the angle by which a direction may be outside.
constexpr btScalar kOutside = btScalar(0.0025);
/// Faces of a piece that count at one point.
constexpr std::size_t kMostFaces = 16;

FlatFace face_through(const btVector3& normal, const btVector3& p) { return {normal, normal.dot(p), true}; }

std::vector<FlatFace> faces_of_box(const btBoxShape& box, const btTransform& pose) {
  std::vector<FlatFace> faces;
  const btVector3 half = box.getHalfExtentsWithMargin();
  for (int axis = 0; axis < 3; ++axis) {
    const btVector3 normal = pose.getBasis().getColumn(axis);
    faces.push_back(face_through(normal, pose.getOrigin() + normal * half[axis]));
    faces.push_back(face_through(-normal, pose.getOrigin() - normal * half[axis]));
  }
  return faces;
}

std::vector<FlatFace> faces_of_hull(const HullFaces& hull, const btTransform& pose) {
  std::vector<FlatFace> faces;
  for (std::size_t i = 0; i < hull.face_count(); ++i) {
    faces.push_back(face_through(pose.getBasis() * hull.normals[i], pose(hull.normals[i] * hull.offsets[i])));
  }
  return faces;
}

}  // namespace

bool FlatPiece::covers(const btVector3& p, btScalar within_m) const {
  if (!is_triangle) return holds(p, within_m);
  return holds(p, within_m, &faces[1]) && faces[1].above(p) <= kGround_m;
}

std::array<FlatFace, 5> faces_of_triangle(const btVector3 (&corners)[3]) {
  std::array<FlatFace, 5> faces = {};
  btVector3 up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(up.length2() > 0)) return faces;
  up.normalize();
  faces[0] = face_through(up, corners[0]);
  faces[1] = face_through(-up, corners[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const btVector3 along = corners[(i + 1) % 3] - corners[i];
    faces[2 + i] = face_through(along.cross(up).normalized(), corners[i]);
    faces[2 + i].is_surface = false;
  }
  return faces;
}

std::vector<FlatFace> faces_of(const btCollisionShape& shape, const btTransform& pose) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return faces_of_box(static_cast<const btBoxShape&>(shape), pose);
    case CUSTOM_POLYHEDRAL_SHAPE_TYPE:  // HullShape
      if (const HullFaces* const faces = hull_faces_of(shape)) return faces_of_hull(*faces, pose);
      return {};
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      return {face_through(pose.getBasis() * plane.getPlaneNormal(),
                           pose(plane.getPlaneNormal() * plane.getPlaneConstant()))};
    }
    default:
      return {};
  }
}

/// The allowed directions are the sums of the normals of the faces at the point. What is left of a direction when the
/// nearest such sum is taken off is how far outside it is.
bool rises_above(const FlatPiece& piece, const btVector3& p, const btVector3& direction, btScalar within_m) {
  std::array<const FlatFace*, kMostFaces> near;
  std::size_t count = 0;
  for (const FlatFace& face : piece.faces) {
    if (face.above(p) > -within_m && count < kMostFaces) near[count++] = &face;
  }
  constexpr int kSweeps = 40;
  std::array<btScalar, kMostFaces> shares = {};
  btVector3 left = direction;
  for (int sweep = 0; sweep < kSweeps && left.length2() > kOutside * kOutside; ++sweep) {
    btScalar changed = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const btScalar more = std::max(-shares[i], left.dot(near[i]->normal));
      shares[i] += more, left -= more * near[i]->normal;
      changed = std::max(changed, btFabs(more));
    }
    if (changed < btScalar(1e-4)) break;
  }
  return left.length2() > kOutside * kOutside;
}

}  // namespace aurasim::physics
