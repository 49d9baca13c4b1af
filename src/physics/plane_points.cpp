#include "physics/plane_points.h"

#include <cstdint>

#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

namespace aurasim::physics {
namespace {

void add(PlanePoints& found, const HalfSpace& plane, const btVector3& p, btScalar radius, std::int32_t feature) {
  const btScalar above = plane.above(p);
  found.points[static_cast<std::size_t>(found.count++)] = {p - plane.normal * above, above - radius, feature};
}

}  // namespace

HalfSpace half_space_of(const btCollisionShape& plane, const btTransform& pose) {
  const auto& shape = static_cast<const btStaticPlaneShape&>(plane);
  const btVector3 normal = pose.getBasis() * shape.getPlaneNormal();
  return {normal, shape.getPlaneConstant() + normal.dot(pose.getOrigin())};
}

PlanePoints plane_points(const Rod& rod, const HalfSpace& plane, double margin_m) {
  PlanePoints found;
  const btScalar most = rod.radius + static_cast<btScalar>(margin_m);
  if (rod.half.isZero()) {
    if (plane.above(rod.centre) <= most) add(found, plane, rod.centre, rod.radius, 0);
    return found;
  }
  for (const int end : {1, 2}) {
    const btVector3 p = rod.at(end == 1 ? -1 : 1);
    if (plane.above(p) <= most) add(found, plane, p, rod.radius, end);
  }
  return found;
}

}  // namespace aurasim::physics
