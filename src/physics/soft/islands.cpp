#include "physics/soft/islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

bool is_asleep(const btRigidBody& body) { return body.getActivationState() == ISLAND_SLEEPING; }

void stop(btRigidBody& body) {
  body.setLinearVelocity({0, 0, 0});
  body.setAngularVelocity({0, 0, 0});
}

}  // namespace

void SoftIslands::insert(btRigidBody& body) {
  if (body.isStaticObject()) return body.setUserIndex3(0);
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(states_.size()));
    states_.push_back(0), parents_.push_back(0), is_active_.push_back(0);
  }
  body.setUserIndex3(static_cast<int>(free_.back()));
  free_.pop_back();
}

void SoftIslands::remove(const btRigidBody& body) {
  const std::uint32_t slot = slot_of(body);
  if (slot == 0) return;
  if (has(slot, kKept)) forget_sleepers();
  states_[slot] = 0;
  free_.push_back(slot);
}

void SoftIslands::forget_past() {
  std::fill(states_.begin() + 1, states_.end(), std::uint8_t{0});
  forget_sleepers();
}

void SoftIslands::call(std::span<btRigidBody* const> bodies) {
  awake_.clear();
  asleep_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i + kPrefetchDistance < bodies.size()) prefetch_flags(*bodies[i + kPrefetchDistance]);
    btRigidBody* const body = bodies[i];
    const std::uint32_t slot = slot_of(*body);
    const bool sleeps = !body->isActive();
    if (sleeps != has(slot, kKept)) forget_sleepers();
    if (!sleeps) parents_[slot] = slot;
    (sleeps ? asleep_ : awake_).push_back(body);
    const int before = has(slot, kSleeps) ? kSlept : 0;
    states_[slot] = static_cast<std::uint8_t>(before | (sleeps ? kSleeps | kKept : kMoves));
  }
  if (!knows_sleepers_) std::iota(parents_.begin(), parents_.end(), 0U);
}

/// First slot of the island. Halves the path to it (union-find).
std::uint32_t SoftIslands::island_of(std::uint32_t slot) {
  while (parents_[slot] != slot) slot = parents_[slot] = parents_[parents_[slot]];
  return slot;
}

void SoftIslands::unite(std::uint32_t a, std::uint32_t b) {
  if (a == 0 || b == 0) return;
  reaches_sleepers_ = reaches_sleepers_ || sleeps(a) != sleeps(b);
  const std::uint32_t one = island_of(a), other = island_of(b);
  parents_[std::max(one, other)] = std::min(one, other);
}

/// Islands sleep as in Bullet: when no body in them is active. One active body keeps all others awake.
void SoftIslands::find(std::span<const SoftTouch> touches, std::span<const SoftTouch> of_sleepers,
                       std::span<btTypedConstraint* const> joints) {
  reaches_sleepers_ = false;
  for (const SoftTouch& touch : touches) unite(touch.slot_a, touch.slot_b);
  for (const SoftTouch& touch : of_sleepers) unite(touch.slot_a, touch.slot_b);
  for (const btTypedConstraint* joint : joints) {
    if (joint->isEnabled()) unite(slot_of(joint->getRigidBodyA()), slot_of(joint->getRigidBodyB()));
  }
  std::ranges::fill(is_active_, std::uint8_t{0});
  for (const btRigidBody* body : awake_) {
    if (body->getActivationState() != WANTS_DEACTIVATION) is_active_[island_of(slot_of(*body))] = 1;
  }
  const bool knew = knows_sleepers_;
  knows_sleepers_ = true;
  put_to_sleep();
  // Contacts ahead of time between bodies that now sleep do not join their islands.
  const auto stay = [this](const SoftTouch& touch) { return !has(touch.slot_a, kMoves) && !has(touch.slot_b, kMoves); };
  if (std::ranges::any_of(touches, [&](const SoftTouch& touch) { return touch.ahead && stay(touch); })) {
    forget_sleepers();
  }
  has_woken_any_ = false;
  if (reaches_sleepers_) wake();
  if (!knew) {
    for (btRigidBody* body : asleep_) {
      if (is_asleep(*body)) stop(*body);
    }
  }
  joints_.clear();
  for (btTypedConstraint* joint : joints) {
    const bool moves = has(slot_of(joint->getRigidBodyA()), kMoves) || has(slot_of(joint->getRigidBodyB()), kMoves);
    if (joint->isEnabled() && moves) joints_.push_back(joint);
  }
  std::ranges::sort(joints_, {}, &btTypedConstraint::getUserConstraintType);
}

void SoftIslands::put_to_sleep() {
  std::erase_if(awake_, [this](btRigidBody* body) {
    const std::uint32_t slot = slot_of(*body);
    if (is_active_[island_of(slot)] != 0) return false;
    body->setActivationState(ISLAND_SLEEPING);
    stop(*body);
    states_[slot] = static_cast<std::uint8_t>((states_[slot] & ~kMoves) | kKept);
    return true;
  });
}

void SoftIslands::wake() {
  for (btRigidBody* body : asleep_) {
    const std::uint32_t slot = slot_of(*body);
    if (is_active_[island_of(slot)] == 0) continue;
    if (!is_asleep(*body)) {  // disabled: takes no part in the world and is alone from now on
      forget_sleepers();
      continue;
    }
    body->setActivationState(WANTS_DEACTIVATION);
    body->setDeactivationTime(0);
    states_[slot] = static_cast<std::uint8_t>((states_[slot] & ~kKept) | kMoves);
    awake_.push_back(body);
    has_woken_any_ = true;
  }
}

/// A counting sort, because touches come in no order and each body has several. Parts matter for compounds only.
void SoftIslands::sort(std::span<const SoftTouch> touches, soft::Team& team) {
  const auto first_of = [](const SoftTouch& touch) { return std::min(touch.a, touch.b); };
  const auto last_of = [](const SoftTouch& touch) { return static_cast<std::size_t>(std::max(touch.a, touch.b)); };
  const auto counts = [&](const SoftTouch& touch) {
    return touch.acts && (has(touch.slot_a, kMoves) || has(touch.slot_b, kMoves));
  };
  int last = -1;
  for (const btRigidBody* body : awake_) last = std::max(last, body->getUserIndex());
  for (const SoftTouch& touch : touches) last = std::max(last, std::max(touch.a, touch.b));
  ends_.assign(static_cast<std::size_t>(last + 2), 0);
  for (const SoftTouch& touch : touches) {
    if (counts(touch)) ++ends_[last_of(touch) + 1];
  }
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  touches_.resize(ends_.back());
  for (const SoftTouch& touch : touches) {
    if (counts(touch)) touches_[ends_[last_of(touch)]++] = touch;
  }

  const auto before = [first_of](const SoftTouch& x, const SoftTouch& y) {
    if (first_of(x) != first_of(y)) return first_of(x) < first_of(y);
    return std::tie(x.a, x.parts) < std::tie(y.a, y.parts);
  };
  // each entry of ends_ is now the end of its body's touches
  team.for_each(ends_.size() - 1, [&](std::size_t body) {
    std::sort(touches_.begin() + static_cast<std::ptrdiff_t>(body > 0 ? ends_[body - 1] : 0),
              touches_.begin() + static_cast<std::ptrdiff_t>(ends_[body]), before);
  });
}

}  // namespace aurasim::physics
