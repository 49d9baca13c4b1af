#include "physics/soft/movers.h"

#include <algorithm>
#include <array>
#include <optional>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/free_rotation.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/settings.h"
#include "physics/soft/convert.h"
#include "physics/soft/flight.h"
#include "physics/soft/shared.h"

namespace aurasim::physics {

using soft::Mover;
using soft::Real;

SoftMovers::SoftMovers(const Settings& settings, soft::Team& team)
    : team_(team),
      step_s_(static_cast<btScalar>(settings.step_s)),
      h_s_(static_cast<Real>(settings.step_s / settings.substeps)),
      block_m_(settings.block_m) {}

void SoftMovers::hold(int user_index) {
  if (user_index < 0) return;
  const auto place = static_cast<std::size_t>(user_index);
  if (mover_at_.size() <= place) mover_at_.resize(place + 1, 0);
  mover_at_[place] = kHeld;
}

void SoftMovers::take_in(const SoftBodies& bodies) {
  gravity_ = bodies.gravity;
  mover_at_.clear();
  for (const SoftTouch& touch : bodies.touches) hold(touch.a), hold(touch.b);
  for (const btTypedConstraint* joint : bodies.joints) {
    hold(joint->getRigidBodyA().getUserIndex()), hold(joint->getRigidBodyB().getUserIndex());
  }
  held_.assign(1, nullptr);
  flying_.clear();
  for (btRigidBody* body : bodies.awake) {
    if (is_held(body->getUserIndex())) {
      held_.push_back(body);
    } else if (!is_guest(*body)) {
      flying_.push_back(body);
    }
  }
  if (team_.employed() > 1) order_by_block();
  if (bodies.shared != nullptr) bodies.shared->make_room(held_);
  make_room(bodies.moving_statics.size());
  take_in_statics(bodies.moving_statics);
  team_.side_by_side([this](const soft::Worker& worker) {
    const auto [first_flying, last_flying] = worker.share(flying_.size());
    for (std::size_t i = first_flying; i < last_flying; ++i) fly(*flying_[i], gravity_, step_s_);
    const auto [first, last] = worker.share(tumblers_.size());
    for (std::size_t row = first; row < last; ++row) take_in_row(row);
    take_in_pushes(first * soft::kLanes, last * soft::kLanes, pushes_[static_cast<std::size_t>(worker.number)].all);
  });
  if (bodies.shared != nullptr) bodies.shared->take_in(movers_, inertias_);
}

/// Sorts the bodies by block, so that what a thread works on lies together. The order of movers changes no bit.
void SoftMovers::order_by_block() {
  unordered_.resize(held_.size());
  team_.for_each(held_.size() - 1, [this](std::size_t i) {
    unordered_[i + 1] = {held_[i + 1], physics::group_of(SoftPhase::kInside, {.block = place_of(*held_[i + 1]).block})};
  });
  std::array<std::size_t, kSoftGroups + 1> next{};
  for (std::size_t i = 1; i < held_.size(); ++i) ++next[unordered_[i].group + 1];
  next[0] = 1;
  for (std::size_t group = 1; group < kSoftGroups; ++group) next[group] += next[group - 1];
  for (std::size_t i = 1; i < held_.size(); ++i) held_[next[unordered_[i].group]++] = unordered_[i].body;
}

void SoftMovers::make_room(std::size_t moving_statics) {
  const auto rows = [](std::size_t count) { return (count + soft::kLanes - 1) / soft::kLanes; };
  held_.resize(rows(held_.size()) * soft::kLanes, nullptr);
  steady_.assign(moving_statics > 0 ? 1 + rows(moving_statics) : 0, soft::Tumblers{});
  all_movers_.resize(steady_.size() * soft::kLanes + held_.size());
  movers_ = all_movers_.data() + steady_.size() * soft::kLanes;
  tumblers_.resize(held_.size() / soft::kLanes);
  inertias_.resize(held_.size());
  bodies_.resize(held_.size());
  places_.resize(held_.size());
  pushes_.resize(static_cast<std::size_t>(team_.size()));
}

/// Makes the movers of moving statics. They go on evenly, whatever they touch.
void SoftMovers::take_in_statics(std::span<btRigidBody* const> moving_statics) {
  mover_of_static_.clear();
  std::fill(all_movers_.data(), movers_, Mover{});
  for (std::size_t i = 0; i < moving_statics.size(); ++i) {
    const auto mover = -1 - static_cast<std::int32_t>(i);
    const auto place = static_cast<std::size_t>(-1 - moving_statics[i]->getUserIndex());
    if (mover_of_static_.size() <= place) mover_of_static_.resize(place + 1, 0);
    mover_of_static_[place] = mover;
    soft::from_bullet(moving_statics[i]->getLinearVelocity(), movers_[mover].v);
    soft::from_bullet(moving_statics[i]->getAngularVelocity(), movers_[mover].w);
  }
}

/// Lists the forces on movers [first, last).
void SoftMovers::take_in_pushes(std::size_t first, std::size_t last, std::vector<PushedMover>& of_thread) const {
  of_thread.clear();
  for (std::size_t i = std::max<std::size_t>(1, first); i < last && held_[i] != nullptr; ++i) {
    const Pushed push = pushed(*held_[i]);
    if (!push.any) continue;
    PushedMover& mover = of_thread.emplace_back();
    mover.mover = i;
    soft::from_bullet(push.v * btScalar(h_s_), mover.v);
    soft::from_bullet(push.w * btScalar(h_s_), mover.w);
  }
}

SoftPhase SoftMovers::phase_of(std::int32_t a, std::int32_t b) const {
  if (a <= 0 || b <= 0) return SoftPhase::kInside;
  return physics::phase_of(places_[static_cast<std::size_t>(a)], places_[static_cast<std::size_t>(b)]);
}

void SoftMovers::take_in_row(std::size_t row) {
  tumblers_[row] = {};
  for (std::size_t i = row * soft::kLanes; i < (row + 1) * soft::kLanes; ++i) take_in(i);
}

void SoftMovers::prefetch_after(std::size_t i) const {
  const std::size_t next = i + kPrefetchDistance / 4;
  if (next < held_.size() && held_[next] != nullptr) prefetch_motion(*held_[next]);
}

void SoftMovers::take_in(std::size_t i) {
  Mover& mover = movers_[i] = {};
  inertias_[i] = {};
  if (held_[i] == nullptr) {
    bodies_[i] = {};
    return;
  }
  prefetch_after(i);
  const btRigidBody& body = *held_[i];
  mover_at_[static_cast<std::size_t>(body.getUserIndex())] = static_cast<std::int32_t>(i);
  soft::from_bullet(body.getLinearVelocity(), mover.v);
  soft::from_bullet(body.getAngularVelocity(), mover.w);
  inertias_[i] = inertia_of(body);
  const btTransform& start = body.getWorldTransform();
  bodies_[i] = {start.getOrigin(), start.getRotation(), body.getLinearVelocity(), body.getAngularVelocity()};
  const BodyPlace& place = place_of(body);
  places_[i] = soft_place(from_bullet(start.getOrigin()), place.block, place.radius_m, block_m_);
  const std::optional<core::Vec3> tumbling = tumbling_inertia(body);
  if (!tumbling) return;
  soft::Tumblers& row = tumblers_[i / soft::kLanes];
  const auto lane = static_cast<int>(i % soft::kLanes);
  row.any = true;
  for (int k = 0; k < 4; ++k) row.start[k][lane] = static_cast<Real>(bodies_[i].q[k]);
  for (int k = 0; k < 3; ++k) {
    row.inertia[k][lane] = static_cast<Real>((*tumbling)[k]);
    row.inv_inertia[k][lane] = 1 / row.inertia[k][lane];
  }
}

void SoftMovers::push(const soft::Worker& worker) {
  const auto [first_row, last_row] = worker.share(tumblers_.size());
  const Real fall[3] = {h_s_ * static_cast<Real>(gravity_[0]), h_s_ * static_cast<Real>(gravity_[1]),
                        h_s_ * static_cast<Real>(gravity_[2])};
  for (std::size_t i = std::max<std::size_t>(1, first_row * soft::kLanes); i < last_row * soft::kLanes; ++i) {
    for (int k = 0; k < 3; ++k) movers_[i].v[k] += fall[k];
  }
  for (const PushedMover& push : pushes_[static_cast<std::size_t>(worker.number)].all) {
    for (int k = 0; k < 3; ++k) movers_[push.mover].v[k] += push.v[k], movers_[push.mover].w[k] += push.w[k];
  }
}

void SoftMovers::move(const soft::Worker& worker) {
  const auto [first_row, last_row] = worker.share(tumblers_.size());
  soft::kernel().move(movers_, tumblers_.data(), first_row, last_row, h_s_,
                      {static_cast<Real>(kTurn), Real{kMostTurns}});
  if (!worker.is_first()) return;
  soft::kernel().move(all_movers_.data(), steady_.data(), 1, std::max<std::size_t>(1, steady_.size()), h_s_, {});
}

/// Adds only the changes of velocities, so the rounding of a mover's speed at the start is not lost.
void SoftMovers::show(std::size_t i) const {
  const Mover& m = movers_[i];
  const Body& body = bodies_[i];
  if (held_[i] == nullptr || is_guest(*held_[i])) return;
  prefetch_after(i);
  const auto after = [](const btVector3& before, const Real(&now)[3]) {
    btVector3 v(0, 0, 0);
    for (int k = 0; k < 3; ++k) v[k] = before[k] + (btScalar(now[k]) - btScalar(static_cast<Real>(before[k])));
    return v;
  };
  held_[i]->setLinearVelocity(after(body.v, m.v));
  held_[i]->setAngularVelocity(after(body.w, m.w));
  const btQuaternion turned(m.dq[0], m.dq[1], m.dq[2], m.dq[3]);
  move_to(*held_[i], btTransform((turned * body.q).normalized(), body.p + soft::to_bullet(m.dp)));
}

void SoftMovers::show() {
  team_.for_each(held_.size() - 1, [this](std::size_t i) { show(i + 1); });
}

}  // namespace aurasim::physics
