#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "physics/bullet_convert.h"
#include "physics/simulation.h"

namespace aurasim::physics {

RayHit Simulation::cast(const core::Vec3& from_W, const core::Vec3& to_W) const {
  const btVector3 from = to_bullet(from_W);
  const btVector3 to = to_bullet(to_W);
  btCollisionWorld::ClosestRayResultCallback nearest(from, to);
  world_.cast(from, to, nearest);
  RayHit hit;
  if (!nearest.hasHit()) return hit;
  hit.object = ref_of(*nearest.m_collisionObject);
  hit.p_W = from_bullet(nearest.m_hitPointWorld);
  hit.normal_W = from_bullet(nearest.m_hitNormalWorld);
  hit.distance_m = (hit.p_W - from_W).norm();
  return hit;
}

}  // namespace aurasim::physics
