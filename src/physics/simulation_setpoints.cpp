// Application of programs' setpoints (core/control_log.h) in each state that a simulation computes.
#include <algorithm>
#include <cmath>
#include <utility>

#include "physics/awaken.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// If setpoints exist for more than this many times the number of bodies here, those of each body are looked up one by
/// one.
constexpr std::size_t kMany = 16;

/// Does the setpoint neither change the body nor keep it awake?
bool is_nothing(core::Quantity quantity, const std::optional<core::Vec3>& value) {
  const bool pushes = quantity == core::Quantity::kForce || quantity == core::Quantity::kTorque;
  return !value || (pushes && value->isZero());
}

/// May a setpoint change a velocity from `before` to `after`? A body beyond the limit may be slowed down.
bool bears(const core::Vec3& before, const core::Vec3& after, double limit) {
  return after.norm() <= std::max(limit, before.norm());
}

/// Velocity and spin of a mobile base that drives.
struct Driven {
  core::Vec3 v_WB, w_WB;
};

/// The motion for a setpoint kDriving. Nothing if the body's x axis is vertical, so that "ahead" has no direction on
/// the ground.
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

/// Largest changes of a body's velocities by setpoints that its predicted path does not hold.
struct ComingPush {
  double linear_m_s = 0, turn_rad_s = 0;

  void add(const ComingPush& other) {
    note_linear(other.linear_m_s);
    note_turn(other.turn_rad_s);
  }

  void note(const btRigidBody& body, core::Quantity quantity, const core::Vec3& value, double foresight_s) {
    switch (quantity) {
      case core::Quantity::kForce:  // an acceleration a takes it a t^2 / 2 off its path in the time t
        return note_linear(foresight_s / 2 * static_cast<double>(body.getInvMass()) * value.norm());
      case core::Quantity::kTorque:
        return note_turn(foresight_s / 2 *
                         static_cast<double>((body.getInvInertiaTensorWorld() * to_bullet(value)).length()));
      case core::Quantity::kVelocity:
        return note_linear((value - from_bullet(body.getLinearVelocity())).norm());
      case core::Quantity::kSpin:
        return note_turn((value - from_bullet(body.getAngularVelocity())).norm());
      case core::Quantity::kDriving:
        return note_driving(body, value, foresight_s);
    }
  }

 private:
  void note_linear(double change_m_s) { linear_m_s = std::max(linear_m_s, change_m_s); }
  void note_turn(double change_rad_s) { turn_rad_s = std::max(turn_rad_s, change_rad_s); }
  /// A base that drives and turns leaves its straight path.
  void note_driving(const btRigidBody& body, const core::Vec3& value, double foresight_s) {
    const std::optional<Driven> after = driven(body, value);
    if (!after) return;
    const double swing = std::min(2.0, foresight_s / 2 * std::abs(value.z())) * value.head<2>().norm();
    note_linear((after->v_WB - from_bullet(body.getLinearVelocity())).norm() + swing);
    note_turn((after->w_WB - from_bullet(body.getAngularVelocity())).norm());
  }
};

}  // namespace

/// Applies the setpoints of state `n` before it is computed. Forces are noted for push(). Setpoints that would make a
/// body too fast are not applied.
void Simulation::heed_setpoints(core::Step n) {
  pushed_.clear();
  new_setpoints_.clear();
  const core::ControlLog& controls = timeline_.controls();
  if (controls.empty()) return;
  const auto take = [&](HostedBody& body, core::Quantity quantity, const auto& value, bool is_new) {
    if (is_guest(*body.rigid)) return;
    if (is_new) new_setpoints_.push_back({body.id, quantity, value});
    if (!body.born || (is_nothing(quantity, value) && !is_new)) return;
    awaken(*body.rigid);
    note(body.id);
    if (value && !heed(*body.rigid, quantity, *value)) ++unbearable_;
  };
  if (table_.size() < controls.body_quantities() / kMany) {
    for (HostedBody& body : table_.bodies()) {
      controls.for_each_of(body.id, n, [&](core::Quantity quantity, const auto& value, bool is_new) {
        take(body, quantity, value, is_new);
      });
    }
  } else {
    HostedBody* body = nullptr;
    std::size_t near = 0;
    const auto is_here = [&](core::BodyId id) { return (body = table_.find(id, near)) != nullptr; };
    controls.for_each_body(n, is_here, [&](core::BodyId, core::Quantity quantity, const auto& value, bool is_new) {
      take(*body, quantity, value, is_new);
    });
  }
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

/// Applies the noted forces. Call before each of Bullet's steps, because Bullet clears forces after each.
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

/// Of bodies that setpoints concern, ascending by place: how much setpoints will change the velocity of the body's
/// surface beyond its predicted path.
std::vector<Simulation::PlacedPush> Simulation::coming_pushes() const {
  std::vector<PlacedPush> pushes;
  const core::ControlLog& controls = timeline_.controls();
  if (controls.empty()) return pushes;
  const core::Step last = step_ + foreseen();
  std::vector<std::pair<std::size_t, ComingPush>> coming;
  std::size_t near = 0;
  const auto is_here = [&](core::BodyId id) {
    const HostedBody* const body = table_.find(id, near);
    return body != nullptr && body->born;
  };
  controls.for_each_ahead(step_ + 1, last, is_here,
                          [&](core::BodyId, core::Quantity quantity, const core::Vec3& value) {
                            if (coming.empty() || coming.back().first != near) coming.emplace_back(near, ComingPush{});
                            coming.back().second.note(*table_[near].rigid, quantity, value, settings_.foresight_s);
                          });
  std::ranges::stable_sort(coming, {}, &std::pair<std::size_t, ComingPush>::first);
  for (std::size_t i = 0; i < coming.size(); ++i) {
    if (i + 1 < coming.size() && coming[i + 1].first == coming[i].first) {
      coming[i + 1].second.add(coming[i].second);
      continue;
    }
    const auto& [place, push] = coming[i];
    const double radius = push.turn_rad_s > 0 ? bounding_radius(table_[place]) : 0;
    pushes.push_back({place, std::min(push.linear_m_s, 2 * settings_.top_speed_m_s) +
                                 std::min(radius * push.turn_rad_s, 2 * settings_.top_speed_m_s)});
  }
  return pushes;
}

}  // namespace aurasim::physics
