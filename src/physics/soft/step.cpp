#include "physics/soft/step.h"

#include <cmath>
#include <optional>
#include <vector>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/free_rotation.h"
#include "physics/soft/joints.h"
#include "physics/soft/mover.h"
#include "physics/soft/patches.h"

namespace aurasim::physics {
namespace {

using soft::Mover;
using soft::Real;

/// An overlap is undone no faster.
constexpr Real kTopPush_m_s = 3;
/// So often joints are solved before contacts in each substep: they start from nothing.
constexpr int kJointSweeps = 4;

btQuaternion turned(const Mover& m) { return {m.dq[0], m.dq[1], m.dq[2], m.dq[3]}; }

void set_turned(Mover& m, const btQuaternion& q) {
  for (int i = 0; i < 4; ++i) m.dq[i] = q[i];
}

/// By the rotation vector rate w over h, to the second order.
void turn(Mover& m, Real h) {
  const Real x = m.dq[0], y = m.dq[1], z = m.dq[2], w = m.dq[3], s = h / 2;
  const Real q[4] = {x + s * (m.w[0] * w + m.w[1] * z - m.w[2] * y), y + s * (m.w[1] * w + m.w[2] * x - m.w[0] * z),
                     z + s * (m.w[2] * w + m.w[0] * y - m.w[1] * x), w - s * (m.w[0] * x + m.w[1] * y + m.w[2] * z)};
  const Real per_length = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) m.dq[i] = q[i] * per_length;
}

}  // namespace

struct SoftStep::Impl {
  Impl(double step_s, int substeps)
      : step_s(static_cast<Real>(step_s)), h_s(static_cast<Real>(step_s / substeps)), substeps(substeps), patches(h_s) {
    forget();
  }

  /// What a body is besides a mover.
  struct Body {
    btTransform start = btTransform::getIdentity();
    bool alone = true;  ///< touches nothing, no joint holds it
    std::optional<core::Vec3> tumbling_inertia;
  };

  void forget();
  void add(btRigidBody& rigid);
  void move(std::uint32_t i, Real h, bool exact);
  void show(std::size_t i) const;
  void run();

  Real step_s, h_s;
  int substeps;
  Real gravity[3] = {};
  std::vector<Mover> movers;        ///< the first never moves
  std::vector<Body> bodies;         ///< as movers
  std::vector<btRigidBody*> rigid;  ///< as movers
  SoftPatches patches;
  SoftJoints joints;
};

SoftStep::SoftStep(double step_s, int substeps) : impl_(std::make_unique<Impl>(step_s, substeps)) {}
SoftStep::~SoftStep() = default;

void SoftStep::Impl::forget() {
  movers.assign(1, {});
  bodies.assign(1, {});
  rigid.assign(1, nullptr);
  patches.clear();
  joints.clear();
}

void SoftStep::Impl::add(btRigidBody& body) {
  set_mover(body, movers.size());
  Mover& mover = movers.emplace_back();
  for (int i = 0; i < 3; ++i) mover.v[i] = body.getLinearVelocity()[i], mover.w[i] = body.getAngularVelocity()[i];
  bodies.push_back({body.getWorldTransform(), true, tumbling_inertia(body)});
  rigid.push_back(&body);
}

/// `exact`: on the parabola; whoever touches something moves as fast as it is at the end, which keeps piles calm.
void SoftStep::Impl::move(std::uint32_t i, Real h, bool exact) {
  Mover& m = movers[i];
  const Body& body = bodies[i];
  for (int k = 0; k < 3; ++k) {
    m.dp[k] += h * m.v[k];
    if (exact) m.dp[k] -= h * h / 2 * gravity[k];
  }
  if (!body.tumbling_inertia) {
    turn(m, h);
    return;
  }
  const btMatrix3x3& start = body.start.getBasis();
  const btMatrix3x3 now = btMatrix3x3(turned(m)) * start;
  const Rotation after = rotate_freely({from_bullet(now), from_bullet(btVector3(m.w[0], m.w[1], m.w[2]))},
                                       *body.tumbling_inertia, static_cast<double>(h));
  btQuaternion q;
  (to_bullet(after.R_WB) * start.transpose()).getRotation(q);
  set_turned(m, q.normalized());
  for (int k = 0; k < 3; ++k) m.w[k] = scalar(after.w_WB[k]);
}

void SoftStep::Impl::run() {
  soft::Substep substep{1 / h_s, kTopPush_m_s, true};
  for (std::uint32_t i = 1; i < movers.size(); ++i) {
    if (!bodies[i].alone) continue;
    for (int k = 0; k < 3; ++k) movers[i].v[k] += step_s * gravity[k];
    move(i, step_s, true);
  }
  for (int s = 0; s < substeps; ++s) {
    for (std::uint32_t i = 1; i < movers.size(); ++i) {
      if (bodies[i].alone) continue;
      for (int k = 0; k < 3; ++k) movers[i].v[k] += h_s * gravity[k];
    }
    patches.warm_start(movers.data());
    if (!joints.empty()) {
      for (const btRigidBody* body : joints.bodies()) show(mover_of(*body));
      joints.begin(h_s);
      for (int sweep = 0; sweep < kJointSweeps; ++sweep) joints.solve(movers.data());
    }
    substep.pushes = true;
    patches.solve(movers.data(), substep);
    for (std::uint32_t i = 1; i < movers.size(); ++i) {
      if (!bodies[i].alone) move(i, h_s, false);
    }
    if (!joints.empty()) joints.solve(movers.data());
    substep.pushes = false;
    patches.solve(movers.data(), substep);
    if (!joints.empty()) joints.finish();
  }
  patches.bounce(movers.data());
}

/// Gives a body where it is now, and how fast.
void SoftStep::Impl::show(std::size_t i) const {
  const Mover& m = movers[i];
  btRigidBody& body = *rigid[i];
  body.setLinearVelocity({m.v[0], m.v[1], m.v[2]});
  body.setAngularVelocity({m.w[0], m.w[1], m.w[2]});
  const btTransform& start = bodies[i].start;
  const btQuaternion q = (turned(m) * start.getRotation()).normalized();
  body.proceedToTransform(btTransform(q, start.getOrigin() + btVector3(m.dp[0], m.dp[1], m.dp[2])));
}

void SoftStep::solve(std::span<btRigidBody* const> bodies, std::span<btPersistentManifold* const> manifolds,
                     std::span<btTypedConstraint* const> joints, const btVector3& gravity) {
  Impl& impl = *impl_;
  impl.forget();
  for (int i = 0; i < 3; ++i) impl.gravity[i] = gravity[i];
  for (btRigidBody* body : bodies) impl.add(*body);
  const auto holds = [&](const btCollisionObject& body) { impl.bodies[mover_of(body)].alone = false; };
  for (const btPersistentManifold* manifold : manifolds) holds(*manifold->getBody0()), holds(*manifold->getBody1());
  for (const btTypedConstraint* joint : joints) holds(joint->getRigidBodyA()), holds(joint->getRigidBodyB());
  impl.patches.add(manifolds);
  impl.joints.add(joints);
  impl.patches.build(impl.rigid);
  impl.run();
  impl.patches.remember();
  for (std::size_t i = 1; i < impl.movers.size(); ++i) impl.show(i);
}

}  // namespace aurasim::physics
