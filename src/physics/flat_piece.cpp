#include "physics/flat_piece.h"

#include <algorithm>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <LinearMath/btConvexHullComputer.h>

namespace aurasim::physics {
namespace {

constexpr btScalar kGround_m = btScalar(0.01);
/// Sine of the angle by which a direction may be outside.
constexpr btScalar kOutside = btScalar(0.0025);
/// Faces of a piece that count at one point.
constexpr std::size_t kMostFaces = 16;
/// Normals whose product is larger belong to one face of a hull, which Bullet may return in triangles.
constexpr btScalar kSameFace = btScalar(1 - 1e-9);

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

/// Hulls are stored without their margin (shapes.cpp), so the faces lie that much outside of the points.
std::vector<FlatFace> faces_of_hull(const btConvexHullShape& hull, const btTransform& pose) {
  const btVector3* const points = hull.getUnscaledPoints();
  if (hull.getNumPoints() < 4) return {};
  btConvexHullComputer computer;
  computer.compute(&points[0].x(), sizeof(btVector3), hull.getNumPoints(), 0, 0);
  std::vector<FlatFace> faces;
  for (int i = 0; i < computer.faces.size(); ++i) {
    const btConvexHullComputer::Edge* const first = &computer.edges[computer.faces[i]];
    const auto corner = [&](int vertex) { return points[computer.original_vertex_index[vertex]]; };
    const btVector3 p = corner(first->getSourceVertex());
    btVector3 normal(0, 0, 0);
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != first->getSourceVertex();
         edge = edge->getNextEdgeOfFace()) {
      normal += (corner(edge->getSourceVertex()) - p).cross(corner(edge->getTargetVertex()) - p);
    }
    if (normal.fuzzyZero()) continue;
    normal.normalize();
    btVector3 middle(0, 0, 0);
    for (int k = 0; k < hull.getNumPoints(); ++k) middle += points[k] / hull.getNumPoints();
    if (normal.dot(middle - p) > 0) normal = -normal;
    FlatFace face = face_through(pose.getBasis() * normal, pose(p + normal * hull.getMargin()));
    const auto same = [&](const FlatFace& other) { return other.normal.dot(face.normal) > kSameFace; };
    if (std::ranges::none_of(faces, same)) faces.push_back(face);
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
    case CONVEX_HULL_SHAPE_PROXYTYPE:
    case CUSTOM_POLYHEDRAL_SHAPE_TYPE:  // HullShape
      return faces_of_hull(static_cast<const btConvexHullShape&>(shape), pose);
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
