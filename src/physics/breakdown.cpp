#include "physics/breakdown.h"

#include <cstdio>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/limits.h"
#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

using namespace core::limits;

/// A sum over the nine entries of a rotation, which are at most 1: not finite if an entry is not.
btScalar sum(const btMatrix3x3& R) { return R[0].dot(R[0]) + R[1].dot(R[1]) + R[2].dot(R[2]); }

std::string text_of(const core::Vec3& v) {
  char text[80];
  std::snprintf(text, sizeof(text), "(%.4g, %.4g, %.4g)", v.x(), v.y(), v.z());
  return text;
}

}  // namespace

/// Comparisons are written so that NaN counts as out of bounds.
bool has_broken_down(const btRigidBody& body) {
  const core::Vec3 p_WB = from_bullet(body.getWorldTransform().getOrigin());
  const bool is_sound = p_WB.cwiseAbs().sum() <= kFarthestBody_m &&
                        body.getLinearVelocity().length2() <= btScalar(kFastestBody_m_s * kFastestBody_m_s) &&
                        body.getAngularVelocity().length2() <= btScalar(kFastestSpin_rad_s * kFastestSpin_rad_s) &&
                        sum(body.getWorldTransform().getBasis()) <= btScalar(4);
  return !is_sound;
}

std::string fault_of(const btRigidBody& body) {
  const core::Vec3 p_WB = from_bullet(body.getWorldTransform().getOrigin());
  const core::Vec3 v_WB = from_bullet(body.getLinearVelocity());
  const core::Vec3 w_WB = from_bullet(body.getAngularVelocity());
  const bool is_finite = p_WB.allFinite() && v_WB.allFinite() && w_WB.allFinite() &&
                         from_bullet(body.getWorldTransform().getBasis()).allFinite();
  const char* const what = !is_finite                         ? "its state is not finite"
                           : v_WB.norm() > kFastestBody_m_s   ? "it is too fast for any world"
                           : w_WB.norm() > kFastestSpin_rad_s ? "it spins too fast for any world"
                                                              : "it is too far out for any world";
  return std::string(what) + ": p " + text_of(p_WB) + " m, v " + text_of(v_WB) + " m/s, w " + text_of(w_WB) + " rad/s";
}

}  // namespace aurasim::physics
