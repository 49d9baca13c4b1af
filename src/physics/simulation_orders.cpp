// Execution of orders (core/order.h) in a simulation when they are due.
#include <algorithm>
#include <cstdio>
#include <variant>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/awaken.h"
#include "physics/bounds.h"
#include "physics/breakdown.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

btVector3 arm_of(const core::Impulse& impulse, const btRigidBody& body) {
  if (!impulse.p_W) return {0, 0, 0};
  return to_bullet(*impulse.p_W) - body.getCenterOfMassPosition();
}

/// Speed (m/s) that bodies beside a static may gain when it is added or removed: it pushes overlapping bodies out, and
/// bodies that rested on it fall.
constexpr double kShove_m_s = 2;

double fastest_spin(const Settings& settings) {
  return core::limits::fastest_spin_rad_s(settings.step_s / settings.substeps);
}

struct Motion {
  core::Vec3 v_WB;
  core::Vec3 w_WB;
};

Motion motion_of(const btRigidBody& body) {
  return {from_bullet(body.getLinearVelocity()), from_bullet(body.getAngularVelocity())};
}

Motion motion_after(const core::Action& action, const btRigidBody& body) {
  Motion motion = motion_of(body);
  if (const auto* impulse = std::get_if<core::Impulse>(&action)) {
    const btVector3 J = to_bullet(impulse->J_W);
    motion.v_WB += from_bullet(J * body.getInvMass());
    motion.w_WB += from_bullet(body.getInvInertiaTensorWorld() * arm_of(*impulse, body).cross(J));
  } else if (const auto* velocity = std::get_if<core::SetVelocity>(&action)) {
    motion.v_WB = velocity->v_WB;
    motion.w_WB = velocity->w_WB.value_or(motion.w_WB);
  }
  return motion;
}

std::string more_than(double is, double allowed, const char* unit, const char* limit) {
  char text[120];
  std::snprintf(text, sizeof(text), "it would make the body %.4g %s fast, allowed: %.4g (%s)", is, unit, allowed,
                limit);
  return text;
}

/// Why an order may not change a body's motion so; empty if it may. A body that is too fast already may be slowed down.
std::string problem_with(const Motion& after, const Motion& before, const Settings& settings) {
  const double spin_limit = fastest_spin(settings);
  const double v = after.v_WB.norm();
  const double w = after.w_WB.norm();
  if (!(v <= std::max(settings.top_speed_m_s, before.v_WB.norm()))) {
    return more_than(v, settings.top_speed_m_s, "m/s", "tolerances.speed");
  }
  if (!(w <= std::max(spin_limit, before.w_WB.norm()))) {
    return more_than(w, spin_limit, "rad/s", "a quarter turn in a substep");
  }
  return {};
}

}  // namespace

/// Executes the orders that are due just before state `n` is computed.
void Simulation::apply_orders(core::Step n) {
  if (timeline_.statics_change()) show_statics(n);
  for (const core::Order& order : timeline_.due(n)) {
    HostedBody* const body = table_.find(*core::body_of(order.action));
    if (body == nullptr) continue;
    if (is_guest(*body->rigid)) {
      if (std::holds_alternative<core::RemoveBody>(order.action)) part_from(body->id);
      continue;
    }
    if (std::holds_alternative<core::RemoveBody>(order.action)) {
      take_out({step_ + 1, body->id, {}});
    } else if (body->born) {
      const Motion after = motion_after(order.action, *body->rigid);
      if (std::string why = problem_with(after, motion_of(*body->rigid), settings_); !why.empty()) {
        declined_.push_back({order.request, std::move(why)});
        continue;
      }
      kick(*body->rigid, order);
    }
    applied_.push_back(order.request);
  }
}

void Simulation::kick(btRigidBody& body, const core::Order& order) {
  awaken(body);
  if (const auto* impulse = std::get_if<core::Impulse>(&order.action)) {
    body.applyImpulse(to_bullet(impulse->J_W), arm_of(*impulse, body));
  } else if (const auto* velocity = std::get_if<core::SetVelocity>(&order.action)) {
    body.setLinearVelocity(to_bullet(velocity->v_WB));
    if (velocity->w_WB) body.setAngularVelocity(to_bullet(*velocity->w_WB));
  }
  note(table_[static_cast<std::size_t>(body.getUserIndex())].id);
}

/// Removes bodies that have broken down, after state step_ has been computed. Every host does the same, because a
/// body's state depends on its island alone.
void Simulation::take_out_what_broke() {
  std::vector<Removal> broken;
  findings_.for_each(Findings::kBroken, table_, notes_.for_step, settings_.block_m, [&](const HostedBody& body) {
    broken.push_back({step_, body.id, fault_of(*body.rigid)});
  });
  for (const Removal& removal : broken) {
    if (coupling_ != nullptr) broken_.push_back(removal.body);
    take_out(removal);
  }
}

/// Wakes the bodies that touch a body.
void Simulation::wake_beside(core::BodyId id) {
  const btRigidBody* const gone = table_.find(id)->rigid.get();
  world_.for_each_contact({&gone, 1}, [&](const ContactView& contact, std::size_t i0, std::size_t) {
    const btCollisionObject& other = i0 == 0 ? contact.body1() : contact.body0();
    if (is_static(other.getUserIndex())) return;
    const HostedBody& woken = table_[static_cast<std::size_t>(other.getUserIndex())];
    awaken(*woken.rigid);
    note(woken.id);
  });
}

void Simulation::take_out(const Removal& removal) {
  const core::BodyId id = removal.body;
  wake_beside(id);
  const std::uint64_t severed = severed_contacts_;
  release({&id, 1});
  severed_contacts_ = severed;  // the removed body's contacts do not count as severed
  removed_.push_back(removal);
}

/// Upper bound of how much orders that are still to come will change the velocity of the body's surface, m/s.
double Simulation::coming_kick(const HostedBody& body, std::span<const std::uint32_t> coming_statics) const {
  if (!body.born) return 0;
  double kick = 0;
  for (const std::uint32_t index : coming_statics) {
    if (bounds_of(*body.rigid).is_near(statics_.bounds(index))) kick += kShove_m_s;
  }
  for (const core::Order& order : timeline_.coming(step_)) {
    if (core::body_of(order.action) != body.id) continue;
    const double radius = bounding_radius(body);
    const btRigidBody& rigid = *body.rigid;
    if (const auto* impulse = std::get_if<core::Impulse>(&order.action)) {
      const btVector3 J = to_bullet(impulse->J_W);
      const btVector3 spin = rigid.getInvInertiaTensorWorld() * arm_of(*impulse, rigid).cross(J);
      // Larger changes are declined, unless the body is too fast already.
      kick += std::min(static_cast<double>(J.length() * rigid.getInvMass()), 2 * settings_.top_speed_m_s) +
              radius * std::min(static_cast<double>(spin.length()), 2 * fastest_spin(settings_));
    } else if (const auto* velocity = std::get_if<core::SetVelocity>(&order.action)) {
      kick += (velocity->v_WB - from_bullet(rigid.getLinearVelocity())).norm();
      if (velocity->w_WB) kick += radius * (*velocity->w_WB - from_bullet(rigid.getAngularVelocity())).norm();
    }
  }
  return kick;
}

}  // namespace aurasim::physics
