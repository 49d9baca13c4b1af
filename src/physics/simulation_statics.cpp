// The statics of a simulation: which exist in which state, and the poses of moving ones.
#include <algorithm>
#include <stdexcept>

#include "core/keep_one_of_each.h"
#include "core/static_path.h"
#include "physics/awaken.h"
#include "physics/bounds.h"
#include "physics/construction.h"
#include "physics/part_surfaces.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// A bouncing body becomes at most so many times as fast as the static that pushes it.
constexpr double kBounced = 2;

}  // namespace

void Simulation::make_moving(std::uint32_t index, bool goes) {
  const auto place = std::ranges::lower_bound(moving_statics_, index, {}, &MovingStatic::index);
  if (place != moving_statics_.end() && place->index == index) {
    place->goes = place->goes || goes;
    return;
  }
  if (!settings_.looks_once()) {
    throw std::invalid_argument(scene_->statics[index].name + " moves, which this solver does not know");
  }
  const MovingStatic& made =
      *moving_statics_.insert(place, {index, scene_->statics[index], std::make_unique<Belt>(), goes});
  btRigidBody& fixed = statics_.hold_always(index);
  physics::make_moving(fixed, *made.belt);
  if (statics_.is_in(index)) world_.begin_moving(fixed);
}

/// Makes statics movable that orders or programs have moved since the last call.
void Simulation::note_moving_statics() {
  if (!settings_.looks_once()) return;  // such moves are refused without the soft step: command_limits.cpp
  timeline_.moves().for_each([this](core::StaticId id) {
    if (core::value_of(id) < statics_.size()) make_moving(core::value_of(id), true);
  });
}

/// Adds and removes statics so that the world has those of state `n`. Wakes bodies that touch or rested on them.
void Simulation::show_statics(core::Step n) {
  const auto first_new = static_cast<std::uint32_t>(statics_.size());
  const std::vector<Bounds> changed = statics_.show(timeline_, n);
  for (auto i = first_new; i < statics_.size(); ++i) {
    if (scene_->statics.moves(i)) make_moving(i, scene_->statics[i].path.has_value());
  }
  if (!changed.empty()) wake_near(changed);
}

void Simulation::wake_near(std::span<const Bounds> changing) {
  const auto is_near_any = [&](const Bounds& of_body) {
    return std::ranges::any_of(changing, [&](const Bounds& there) { return of_body.is_near(there); });
  };
  find_near(changing);
  for (const std::uint32_t place : near_) {
    HostedBody& body = table_[place];
    if (!is_near_any(bounds_of(*body.rigid))) continue;
    awaken(*body.rigid);
    note(body.id);
  }
}

/// Sets near_ to the places of the born bodies whose broadphase's boxes are near one of `places`; ascending.
void Simulation::find_near(std::span<const Bounds> places) {
  near_.clear();
  for (const Bounds& bounds : places) world_.find_near(bounds, near_);
  core::keep_one_of_each(near_);
}

/// Notes bodies near a place for the next snapshot.
void Simulation::note_near(const Bounds& where) {
  if (notes_.for_snapshot.all()) return;
  find_near({&where, 1});
  for (const std::uint32_t place : near_) notes_.for_snapshot.note(table_[place].id);
}

core::Pose Simulation::pose_of(const MovingStatic& moving, core::Step n) const {
  return timeline_.moves().pose(moving.body, core::StaticId{moving.index}, n, settings_.step_s);
}

/// Places moving statics at their poses of the present state.
void Simulation::place_moving_statics() {
  note_moving_statics();
  for (const MovingStatic& moving : moving_statics_) {
    if (!moving.goes) continue;
    const btTransform pose = to_bullet(pose_of(moving, step_));
    statics_.find(moving.index)->setWorldTransform(pose);
    if (statics_.is_in(moving.index)) world_.bound(*statics_.find(moving.index), pose);
  }
}

/// Gives moving statics the velocities that take them to the next state. Wakes bodies that they may push.
void Simulation::start_moving_statics() {
  std::vector<Bounds> ways;
  note_moving_statics();
  for (const MovingStatic& moving : moving_statics_) {
    if (!statics_.is_in(moving.index)) continue;
    const core::StaticBody& body = moving.body;
    btRigidBody& rigid = *statics_.find(moving.index);
    const core::Pose X_WS = pose_of(moving, step_ + 1);
    const core::Twist twist = core::twist_between(pose_of(moving, step_), X_WS, settings_.step_s);
    const btTransform after = to_bullet(X_WS);
    rigid.setLinearVelocity(to_bullet(twist.v_W));
    rigid.setAngularVelocity(to_bullet(twist.w_W));
    moving.belt->v_W = rigid.getWorldTransform().getBasis() * to_bullet(body.belt_S);
    if (moving.goes) world_.bound(rigid, after);
    if (twist.v_W.isZero() && twist.w_W.isZero() && body.belt_S.isZero()) continue;
    ways.push_back(bounds_of(rigid));
    ways.back().add(bounds_of(*rigid.getCollisionShape(), after));
  }
  if (!ways.empty()) wake_near(ways);
}

/// Pushes that moving statics may give during the states for which other nodes act upon the present auras (foreseen()).
std::vector<Simulation::Shove> Simulation::coming_shoves() const {
  std::vector<Shove> shoves;
  for (const MovingStatic& moving : moving_statics_) {
    if (!statics_.is_in(moving.index)) continue;
    const core::StaticBody& body = moving.body;
    const btCollisionShape& shape = *statics_.find(moving.index)->getCollisionShape();
    Shove shove{bounds_of(*statics_.find(moving.index)), 0};
    const core::Step last = moving.goes ? step_ + foreseen() : step_;
    core::Pose before = pose_of(moving, step_);
    for (core::Step n = step_ + 1; n <= last; ++n) {
      const core::Pose after = pose_of(moving, n);
      shove.where.add(bounds_of(shape, to_bullet(after)));
      const core::Twist twist = core::twist_between(before, after, settings_.step_s);
      const double arm = twist.w_W.isZero() ? 0 : core::bounding_radius(scene_->shapes[body.shape].shape);
      shove.speed_m_s = std::max(shove.speed_m_s, twist.v_W.norm() + twist.w_W.norm() * arm);
      before = after;
    }
    shove.speed_m_s += body.belt_S.norm();
    if (shove.speed_m_s > 0) shoves.push_back(shove);
  }
  return shoves;
}

/// Upper bound of how much `shoves` will change the velocity of the body's surface, m/s.
double Simulation::coming_shove(const HostedBody& body, std::span<const Shove> shoves) const {
  if (!body.born || shoves.empty()) return 0;
  const btScalar way = body.rigid->getLinearVelocity().length() * btScalar(settings_.foresight_s);
  const auto most_in = [&](const Bounds& where) {
    double most = 0;
    for (const Shove& shove : shoves) {
      if (kBounced * shove.speed_m_s > most && where.is_near(shove.where)) most = kBounced * shove.speed_m_s;
    }
    return most;
  };
  if (most_in(bounds_of(*body.rigid->getBroadphaseProxy()).grown(way)) == 0) return 0;  // fast test first
  return most_in(bounds_of(*body.rigid).grown(way));
}

}  // namespace aurasim::physics
