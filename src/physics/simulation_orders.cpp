// What a simulation does with orders (core/order.h) when they are due.
#include <algorithm>
#include <variant>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/bullet_convert.h"
#include "physics/prefetch.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// What a static does to bodies beside it when it comes or goes: it pushes those that it is put into out of itself, and
/// lets those fall that rested on it.
constexpr double kShove_m_s = 2;

/// Also a body that had fallen asleep starts anew. One that is never to sleep stays so.
void wake(btRigidBody& body) {
  if (body.getActivationState() == DISABLE_DEACTIVATION || body.getActivationState() == DISABLE_SIMULATION) return;
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0);
}

/// Do the boxes around two objects come within 10 cm of each other?
bool near(const btRigidBody& a, const btRigidBody& b) {
  btVector3 low_a, high_a, low_b, high_b;
  a.getAabb(low_a, high_a);
  b.getAabb(low_b, high_b);
  constexpr btScalar kNear = btScalar(0.1);
  for (int axis = 0; axis < 3; ++axis) {
    if (low_a[axis] - kNear > high_b[axis] || high_a[axis] + kNear < low_b[axis]) return false;
  }
  return true;
}

btVector3 arm_of(const core::Impulse& impulse, const btRigidBody& body, const LocalFrame& frame) {
  if (!impulse.p_W) return {0, 0, 0};
  return frame.to_local(*impulse.p_W) - body.getCenterOfMassPosition();
}

}  // namespace

/// Before state `n` is computed.
void Simulation::apply_orders(core::Step n) {
  if (timeline_.statics_change()) show_statics(n);
  for (const core::Order& order : timeline_.due(n)) {
    HostedBody* const body = table_.find(*core::body_of(order.action));
    if (body == nullptr) continue;
    applied_.push_back(order.request);
    if (std::holds_alternative<core::RemoveBody>(order.action)) {
      take_out(body->id);
    } else if (body->born) {
      kick(*body->rigid, order);
    }
  }
}

void Simulation::kick(btRigidBody& body, const core::Order& order) {
  wake(body);
  if (const auto* impulse = std::get_if<core::Impulse>(&order.action)) {
    body.applyImpulse(to_bullet(impulse->J_W), arm_of(*impulse, body, frame_));
  } else if (const auto* velocity = std::get_if<core::SetVelocity>(&order.action)) {
    body.setLinearVelocity(to_bullet(velocity->v_WB));
    if (velocity->w_WB) body.setAngularVelocity(to_bullet(*velocity->w_WB));
  }
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

void Simulation::take_out(core::BodyId id) {
  for_each_touching(world_.manifolds(), [&](const btPersistentManifold& manifold) {
    const btRigidBody* const gone = table_.find(id)->rigid.get();
    for (const auto& [one, other] :
         {std::pair(manifold.getBody0(), manifold.getBody1()), std::pair(manifold.getBody1(), manifold.getBody0())}) {
      if (one == gone && other->getUserIndex() >= 0)
        wake(*table_[static_cast<std::size_t>(other->getUserIndex())].rigid);
    }
  });
  const std::uint64_t severed = severed_contacts_;
  release({&id, 1});
  severed_contacts_ = severed;  // nothing was cut that should have gone along
  removed_.push_back({step_ + 1, id});
}

/// Puts in and takes out what stands in state `n`; wakes the bodies that it touches or that rested on it.
void Simulation::show_statics(core::Step n) {
  make_statics();
  for (std::size_t i = 0; i < statics_.size(); ++i) {
    const bool stands = timeline_.stands(static_cast<std::uint32_t>(i), n);
    if (stands == static_is_in_[i]) continue;
    btRigidBody* const changing = statics_[i].get();
    wake_around(*changing);
    if (stands) {
      world_.insert(*changing, 1 + static_cast<int>(i));
    } else {
      world_.remove({&changing, 1});
    }
    static_is_in_[i] = stands;
  }
}

void Simulation::wake_around(const btRigidBody& changing) {
  for (HostedBody& body : table_.bodies()) {
    if (body.born && near(*body.rigid, changing)) wake(*body.rigid);
  }
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

/// How much an order that is still to come will change the velocity of the body's surface, m/s.
double Simulation::coming_kick(const HostedBody& body, std::span<const std::uint32_t> coming_statics) const {
  if (!body.born) return 0;
  double kick = 0;
  for (const std::uint32_t index : coming_statics) {
    if (near(*body.rigid, *statics_[index])) kick += kShove_m_s;
  }
  for (const core::Order& order : timeline_.coming(step_)) {
    if (core::body_of(order.action) != body.id) continue;
    const double radius =
        core::bounding_radius(scene_->shapes.at(scene_->prototypes.at(core::value_of(body.prototype)).shape).shape);
    const btRigidBody& rigid = *body.rigid;
    if (const auto* impulse = std::get_if<core::Impulse>(&order.action)) {
      const btVector3 J = to_bullet(impulse->J_W);
      const btVector3 spin = rigid.getInvInertiaTensorWorld() * arm_of(*impulse, rigid, frame_).cross(J);
      kick += static_cast<double>(J.length() * rigid.getInvMass()) + radius * static_cast<double>(spin.length());
    } else if (const auto* velocity = std::get_if<core::SetVelocity>(&order.action)) {
      kick += (velocity->v_WB - from_bullet(rigid.getLinearVelocity())).norm();
      if (velocity->w_WB) kick += radius * (*velocity->w_WB - from_bullet(rigid.getAngularVelocity())).norm();
    }
  }
  return kick;
}

}  // namespace aurasim::physics
