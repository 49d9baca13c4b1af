#include "physics/soft/flight.h"

#include <optional>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/free_rotation.h"
#include "physics/moving_body.h"

namespace aurasim::physics {
namespace {

/// The turn by the rotation vector v, rad. Uses the series up to half a radian; longer vectors are halved first and the
/// turn is doubled as often.
btQuaternion turn_by(btVector3 v) {
  int halved = 0;
  for (; v.length2() > 1 && halved < 20; ++halved) v /= 2;
  const btScalar x2 = v.length2() / 4;  // square of half the angle
  const btScalar cosine = 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56 * (1 - x2 / 90 * (1 - x2 / 132)))));
  const btScalar sinc = 1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72 * (1 - x2 / 110 * (1 - x2 / 156)))));
  btQuaternion q(v.x() / 2 * sinc, v.y() / 2 * sinc, v.z() / 2 * sinc, cosine);
  for (; halved > 0; --halved) q *= q;
  return q;
}

/// Moves a body without forces: on its parabola, with free rotation.
void fly_freely(btRigidBody& body, const btVector3& gravity, btScalar step_s) {
  const btTransform& start = body.getWorldTransform();
  const btVector3 v = body.getLinearVelocity();
  const btVector3 p = start.getOrigin() + step_s * (v + gravity * (step_s / 2));
  body.setLinearVelocity(v + step_s * gravity);
  if (const std::optional<core::Vec3> inertia = tumbling_inertia(body)) {
    const Rotation now{from_bullet(start.getBasis()), from_bullet(body.getAngularVelocity())};
    const Rotation after = rotate_freely(now, *inertia, static_cast<double>(step_s));
    body.setAngularVelocity(to_bullet(after.w_WB));
    move_to(body, btTransform(to_bullet(after.R_WB), p));
  } else if (!body.getAngularVelocity().isZero()) {
    const btQuaternion q = turn_by(body.getAngularVelocity() * step_s) * start.getRotation();
    move_to(body, btTransform(q.normalized(), p));
  } else {
    move_to(body, btTransform(start.getBasis(), p));
  }
}

}  // namespace

Pushed pushed(const btRigidBody& body) {
  if (body.getTotalForce().isZero() && body.getTotalTorque().isZero()) return {};
  return {body.getInvMass() * body.getTotalForce(), body.getInvInertiaTensorWorld() * body.getTotalTorque(), true};
}

void fly(btRigidBody& body, const btVector3& gravity, btScalar step_s) {
  const Pushed push = pushed(body);
  if (!push.any) return fly_freely(body, gravity, step_s);
  const btVector3 half = push.w * (step_s / 2);
  body.setAngularVelocity(body.getAngularVelocity() + half);
  fly_freely(body, gravity + push.v, step_s);
  body.setAngularVelocity(body.getAngularVelocity() + half);
}

}  // namespace aurasim::physics
