#include "physics/lowest_point.h"

#include <algorithm>

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>

namespace aurasim::physics {
namespace {

/// How much the search looks towards the contact: a body that leans by less shows its points there.
constexpr btScalar kTowards = btScalar(0.05);
/// Cylinders whose axis has a smaller product with `up` lie.
constexpr btScalar kLies = btScalar(0.7);

}  // namespace

btVector3 lowest_point(const PlacedShape& body, const btVector3& up, const btVector3& contact,
                       const btVector3& normal) {
  const btVector3 centre = body.pose.getOrigin();
  const btVector3 to_contact = contact - centre;
  if (body.shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
    return centre - up * static_cast<const btConvexShape&>(body.shape).getMargin();
  }
  if (body.shape.getShapeType() == CAPSULE_SHAPE_PROXYTYPE) {
    return contact + (normal - up) * static_cast<const btCapsuleShape&>(body.shape).getRadius();
  }
  if (body.shape.getShapeType() == CYLINDER_SHAPE_PROXYTYPE) {
    const auto& cylinder = static_cast<const btCylinderShape&>(body.shape);
    const btVector3 axis = body.pose.getBasis().getColumn(cylinder.getUpAxis());
    if (btFabs(axis.dot(up)) < kLies) {
      const btScalar half = cylinder.getHalfExtentsWithMargin()[cylinder.getUpAxis()];
      const btVector3 down = (axis * axis.dot(up) - up).normalized();
      return centre + axis * std::clamp(to_contact.dot(axis), -half, half) + down * cylinder.getRadius();
    }
  }
  btVector3 aside = to_contact - up * up.dot(to_contact);
  if (!aside.fuzzyZero()) aside = aside.normalized() * kTowards;
  const btVector3 direction = body.pose.getBasis().transpose() * (aside - up);
  return body.pose(static_cast<const btConvexShape&>(body.shape).localGetSupportingVertex(direction));
}

}  // namespace aurasim::physics
