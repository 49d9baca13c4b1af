// Axis-aligned boxes around objects.
#pragma once

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>

#include "core/region_map.h"

namespace aurasim::physics {

struct Bounds {
  btVector3 low{BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT};
  btVector3 high{-BT_LARGE_FLOAT, -BT_LARGE_FLOAT, -BT_LARGE_FLOAT};

  void add(const Bounds& other) { low.setMin(other.low), high.setMax(other.high); }
  Bounds grown(btScalar by) const { return {low - btVector3(by, by, by), high + btVector3(by, by, by)}; }
  static constexpr btScalar kNear_m = btScalar(0.1);
  /// Do the two boxes come within kNear_m of each other?
  bool is_near(const Bounds& other) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (low[axis] - kNear_m > other.high[axis] || high[axis] + kNear_m < other.low[axis]) return false;
    }
    return true;
  }
};

inline Bounds bounds_of(const btCollisionShape& shape, const btTransform& pose) {
  Bounds bounds;
  shape.getAabb(pose, bounds.low, bounds.high);
  return bounds;
}
inline Bounds bounds_of(const btRigidBody& body) {
  return bounds_of(*body.getCollisionShape(), body.getWorldTransform());
}
inline bool overlap(const Bounds& a, const Bounds& b) { return TestAabbAgainstAabb2(a.low, a.high, b.low, b.high); }
/// Do the box and the area overlap in the x-y plane?
inline bool overlap(const Bounds& bounds, const core::Rectangle& area) {
  return bounds.low.x() <= area.x1 && bounds.high.x() >= area.x0 && bounds.low.y() <= area.y1 &&
         bounds.high.y() >= area.y0;
}
/// Is the box within the area in the x-y plane?
inline bool is_within(const Bounds& bounds, const core::Rectangle& area) {
  return bounds.low.x() >= area.x0 && bounds.high.x() <= area.x1 && bounds.low.y() >= area.y0 &&
         bounds.high.y() <= area.y1;
}
/// The broadphase's box of an object, which contains bounds_of(body).
inline Bounds bounds_of(const btBroadphaseProxy& proxy) { return {proxy.m_aabbMin, proxy.m_aabbMax}; }

}  // namespace aurasim::physics
