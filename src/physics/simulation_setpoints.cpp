// What a simulation does with the setpoints of programs (core/control_log.h), in each state that it computes.
#include <algorithm>
#include <cmath>

#include "physics/awaken.h"
#include "physics/bullet_convert.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// It neither changes the body nor keeps it awake.
bool is_nothing(core::Quantity quantity, const std::optional<core::Vec3>& value) {
  const bool pushes = quantity == core::Quantity::kForce || quantity == core::Quantity::kTorque;
  return !value || (pushes && value->isZero());
}

/// How much of its speed a body may be given in a state; who is faster already may be slowed down.
bool bears(const core::Vec3& before, const core::Vec3& after, double limit) {
  return after.norm() <= std::max(limit, before.norm());
}

/// A body's velocity and spin, as a mobile base that drives has them.
struct Driven {
  core::Vec3 v_WB, w_WB;
};

/// Nothing: it stands on end, and ahead is nowhere on the ground.
std::optional<Driven> driven(const btRigidBody& body, const core::Vec3& value) {
  constexpr double kFlat = 1e-6;
  const core::Vec3 x_W = from_bullet(body.getWorldTransform().getBasis().getColumn(0));
  const double length = x_W.head<2>().norm();
  if (length < kFlat) return std::nullopt;
  const double cosine = x_W.x() / length, sine = x_W.y() / length;
  Driven after{from_bullet(body.getLinearVelocity()), from_bullet(body.getAngularVelocity())};
  after.v_WB.x() = cosine * value.x() - sine * value.y();
  after.v_WB.y() = sine * value.x() + cosine * value.y();
  after.w_WB.z() = value.z();
  return after;
}

/// How much driving will change the velocity of the body's surface, m/s: it goes on in a curve.
double coming_turn(const btRigidBody& body, const core::Vec3& value, double radius, double foresight_s) {
  const std::optional<Driven> after = driven(body, value);
  if (!after) return 0;
  const core::Vec3 dv = after->v_WB - from_bullet(body.getLinearVelocity());
  const core::Vec3 dw = after->w_WB - from_bullet(body.getAngularVelocity());
  const double swing = std::min(2.0, foresight_s / 2 * std::abs(value.z())) * value.head<2>().norm();
  return dv.norm() + swing + radius * dw.norm();
}

}  // namespace

/// Before state `n` is computed. Forces are noted; what would make a body too fast is not obeyed.
void Simulation::heed_setpoints(core::Step n) {
  pushed_.clear();
  new_setpoints_.clear();
  const core::ControlLog& controls = timeline_.controls();
  if (controls.empty()) return;
  HostedBody* body = nullptr;
  const auto is_here = [&](core::BodyId id) { return (body = table_.find(id)) != nullptr; };
  controls.for_each_body(
      n, is_here, [&](core::BodyId id, core::Quantity quantity, const std::optional<core::Vec3>& value, bool is_new) {
        if (is_new) new_setpoints_.push_back({id, quantity, value});
        if (!body->born || (is_nothing(quantity, value) && !is_new)) return;
        awaken(*body->rigid);
        snapshot_is_fresh_ = records_are_fresh_ = false;
        if (value && !heed(*body->rigid, quantity, *value)) ++unbearable_;
      });
  controls.for_each_joint(n, [&](core::JointId id, const std::optional<core::JointDrive>& drive, bool is_new) {
    if (!contains(scene_->joints[core::value_of(id)].a)) return;
    if (drive) {
      joints_.drive(id, *drive);
    } else if (is_new) {
      joints_.let_go(id);
    }
  });
}

bool Simulation::heed(btRigidBody& body, core::Quantity quantity, const core::Vec3& value) {
  const core::Vec3 v = from_bullet(body.getLinearVelocity()), w = from_bullet(body.getAngularVelocity());
  const double fastest = settings_.top_speed_m_s;
  const double spin = core::limits::fastest_spin_rad_s(settings_.step_s / settings_.substeps);
  const auto push = [&]() -> Push& {
    if (pushed_.empty() || pushed_.back().body != &body) pushed_.push_back({&body, {0, 0, 0}, {0, 0, 0}});
    return pushed_.back();
  };
  switch (quantity) {
    case core::Quantity::kForce: {
      const core::Vec3 dv = settings_.step_s * static_cast<double>(body.getInvMass()) * value;
      if (!bears(v, v + dv, fastest)) return false;
      push().force = to_bullet(value);
      return true;
    }
    case core::Quantity::kTorque: {
      const core::Vec3 dw = settings_.step_s * from_bullet(body.getInvInertiaTensorWorld() * to_bullet(value));
      if (!bears(w, w + dw, spin)) return false;
      push().torque = to_bullet(value);
      return true;
    }
    case core::Quantity::kVelocity:
      if (!bears(v, value, fastest)) return false;
      body.setLinearVelocity(to_bullet(value));
      return true;
    case core::Quantity::kSpin:
      if (!bears(w, value, spin)) return false;
      body.setAngularVelocity(to_bullet(value));
      return true;
    case core::Quantity::kDriving: {
      const std::optional<Driven> after = driven(body, value);
      if (!after) return true;
      if (!bears(v, after->v_WB, fastest) || !bears(w, after->w_WB, spin)) return false;
      body.setLinearVelocity(to_bullet(after->v_WB));
      body.setAngularVelocity(to_bullet(after->w_WB));
      return true;
    }
  }
  return false;
}

/// Bullet forgets forces after each of its steps.
void Simulation::push() {
  for (const Push& push : pushed_) {
    push.body->clearForces();
    push.body->applyCentralForce(push.force);
    push.body->applyTorque(push.torque);
  }
}

void Simulation::stop_pushing() {
  for (const Push& push : pushed_) push.body->clearForces();
  pushed_.clear();
}

/// `hint`: as of ControlLog::for_each_ahead(). How much setpoints will change the velocity of the body's surface, m/s,
/// as far as its path does not tell.
double Simulation::coming_push(const HostedBody& body, std::size_t& hint) const {
  const core::ControlLog& controls = timeline_.controls();
  if (!body.born || controls.empty()) return 0;
  const btRigidBody& rigid = *body.rigid;
  const auto radius = [&] {  // of bodies that are turned; of a hull it is looked for
    return core::bounding_radius(scene_->shapes.at(scene_->prototypes.at(core::value_of(body.prototype)).shape).shape);
  };
  double most[core::kQuantities] = {};
  const core::Step last = step_ + foreseen();
  controls.for_each_ahead(body.id, step_ + 1, last, hint, [&](core::Quantity quantity, const core::Vec3& value) {
    double kick = 0;
    switch (quantity) {
      case core::Quantity::kForce:  // in the time t it comes t^2 / 2 off its path
        kick = settings_.foresight_s / 2 * static_cast<double>(rigid.getInvMass()) * value.norm();
        break;
      case core::Quantity::kTorque:
        kick = settings_.foresight_s / 2 * radius() *
               static_cast<double>((rigid.getInvInertiaTensorWorld() * to_bullet(value)).length());
        break;
      case core::Quantity::kVelocity:
        kick = (value - from_bullet(rigid.getLinearVelocity())).norm();
        break;
      case core::Quantity::kSpin:
        kick = radius() * (value - from_bullet(rigid.getAngularVelocity())).norm();
        break;
      case core::Quantity::kDriving:
        kick = coming_turn(rigid, value, radius(), settings_.foresight_s);
        break;
    }
    double& of_quantity = most[static_cast<std::size_t>(quantity)];
    of_quantity = std::max(of_quantity, kick);
  });
  const double linear = std::max({most[0], most[2], most[4]}), turning = std::max(most[1], most[3]);
  return std::min(linear, 2 * settings_.top_speed_m_s) + std::min(turning, 2 * settings_.top_speed_m_s);
}

}  // namespace aurasim::physics
