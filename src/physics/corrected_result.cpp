#include "physics/corrected_result.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace aurasim::physics {

void CorrectedResult::addContactPoint(const btVector3& normal, const btVector3& on_b, btScalar gap_m) {
  const bool is_swapped = m_manifoldPtr->getBody0() != m_body0Wrap->getCollisionObject();
  const btCollisionObjectWrapper& a = *(is_swapped ? m_body1Wrap : m_body0Wrap);
  const btCollisionObjectWrapper& b = *(is_swapped ? m_body0Wrap : m_body1Wrap);
  if (gap_m > m_manifoldPtr->getContactBreakingThreshold()) return;
  if (const std::optional<PointOnB> point = corrected(a, b, {normal, on_b, gap_m})) {
    btManifoldResult::addContactPoint(point->normal, point->on_b, point->gap_m);
  }
}

std::optional<PointOnB> CorrectedResult::corrected(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                                                   const PointOnB& found) {
  const bool is_on_static = b.getCollisionObject()->isStaticOrKinematicObject();
  const btVector3 on_a = found.on_b + found.normal * found.gap_m;
  const StaticContact on_static = is_on_static ? StaticContact{found.normal, on_a, found.gap_m}
                                               : StaticContact{-found.normal, found.on_b, found.gap_m};
  const btCollisionObjectWrapper &fixed = is_on_static ? b : a, &body = is_on_static ? a : b;
  const std::optional<StaticContact> contact = inner_edges_.corrected(
      on_static, *fixed.getCollisionObject(), fixed.m_index, {*fixed.getCollisionShape(), fixed.getWorldTransform()},
      {*body.getCollisionShape(), body.getWorldTransform()});
  if (!contact) {
    has_left_out_ = true;
    return {};
  }
  if (*contact == on_static) return found;  // to the bit, as where no other piece is beside the static
  return is_on_static ? PointOnB{contact->normal, contact->on_static(), contact->gap_m}
                      : PointOnB{-contact->normal, contact->on_body, contact->gap_m};
}

}  // namespace aurasim::physics
