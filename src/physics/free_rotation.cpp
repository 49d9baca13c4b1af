#include "physics/free_rotation.h"

#include <algorithm>
#include <cmath>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

/// Momentum in the body's frame and the turn made so far, as a quaternion of any length.
struct Turning {
  core::Vec3 momentum;
  core::Quat q_BB;
};

/// Turns about one axis: the flow of that axis's kinetic energy alone. The series of the tangent suffices: its last
/// term is 1e-11 at kTurn.
void turn(Turning& t, int axis, double inverse_inertia, double dt_s) {
  const double angle = t.momentum[axis] * inverse_inertia * dt_s;
  const double square = angle * angle;
  const double s = angle / 2 * (1 + square / 12 * (1 + square / 10));
  const double sine = 2 * s / (1 + s * s);
  const double cosine = 1 - s * sine;
  const int j = (axis + 1) % 3;
  const int k = (axis + 2) % 3;
  const double m_j = t.momentum[j];
  const double m_k = t.momentum[k];
  t.momentum[j] = cosine * m_j + sine * m_k;
  t.momentum[k] = cosine * m_k - sine * m_j;
  core::Quat part(1, 0, 0, 0);
  part.coeffs()[axis] = s;
  t.q_BB = t.q_BB * part;
}

}  // namespace

Rotation rotate_freely(const Rotation& start, const core::Vec3& inertia, double dt_s) {
  const core::Vec3 inverse = inertia.cwiseInverse();
  const core::Vec3 momentum_B = inertia.cwiseProduct(start.R_WB.transpose() * start.w_WB);
  const core::Vec3 momentum_W = start.R_WB * momentum_B;
  const double fastest = momentum_B.norm() * inverse.maxCoeff();
  const int parts = static_cast<int>(std::clamp(std::ceil(fastest * dt_s / kTurn), 1.0, double{kMostTurns}));
  const double h = dt_s / parts;
  Turning t{momentum_B, core::Quat(start.R_WB)};
  for (int i = 0; i < parts; ++i) {
    turn(t, 0, inverse[0], h / 2);
    turn(t, 1, inverse[1], h / 2);
    turn(t, 2, inverse[2], h);
    turn(t, 1, inverse[1], h / 2);
    turn(t, 0, inverse[0], h / 2);
  }
  const core::Mat3 R_WB = t.q_BB.normalized().toRotationMatrix();
  return {R_WB, R_WB * inverse.cwiseProduct(R_WB.transpose() * momentum_W)};
}

bool turns_evenly(const core::Vec3& inertia) {
  // relative difference that counts as equal, because inertia was rounded to single precision
  constexpr double kSame = 1e-6;
  return inertia.maxCoeff() - inertia.minCoeff() <= kSame * inertia.maxCoeff();
}

std::optional<core::Vec3> tumbling_inertia(const btRigidBody& body) {
  if (body.getAngularVelocity().length2() < btScalar(kSlowSpin * kSlowSpin)) return std::nullopt;
  const btVector3& inverse_inertia = body.getInvInertiaDiagLocal();
  if (inverse_inertia[inverse_inertia.minAxis()] <= 0) return std::nullopt;
  const core::Vec3 inertia = from_bullet(inverse_inertia).cwiseInverse();
  if (turns_evenly(inertia)) return std::nullopt;
  return inertia;
}

}  // namespace aurasim::physics
