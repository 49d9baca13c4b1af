#include "physics/soft/islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/moving_body.h"
#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

/// A body with lower speeds is still, m/s and rad/s. Bullet's own thresholds of 0.8 m/s and 1 rad/s decide when a body
/// may fall asleep. They are too high for a body that leans on others: what moves at such a speed takes them along.
constexpr btScalar kStill_m_s = btScalar(0.05), kStill_rad_s = btScalar(0.1);

bool is_asleep(const btRigidBody& body) { return body.getActivationState() == ISLAND_SLEEPING; }

bool is_still(const btRigidBody& body) {
  return body.getLinearVelocity().length2() < kStill_m_s * kStill_m_s &&
         body.getAngularVelocity().length2() < kStill_rad_s * kStill_rad_s;
}

/// Has it been slow for as long as Bullet asks?
bool wants_to_sleep(const btRigidBody& body) {
  return body.getActivationState() != DISABLE_DEACTIVATION && body.getDeactivationTime() > gDeactivationTime;
}

/// Does it leave its neighbours in peace? A body that was woken and has not been moved is calm at once, so that waking
/// goes no farther than motion.
bool is_calm(const btRigidBody& body) {
  return body.getActivationState() == WANTS_DEACTIVATION || (wants_to_sleep(body) && is_still(body));
}

void stop(btRigidBody& body) {
  body.setLinearVelocity({0, 0, 0});
  body.setAngularVelocity({0, 0, 0});
}

}  // namespace

void SoftIslands::insert(btRigidBody& body) {
  if (body.isStaticObject()) return body.setUserIndex3(0);
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(states_.size()));
    states_.push_back(0), parents_.push_back(0), parts_.push_back(0);
    blocks_.emplace_back(), bodies_.push_back(nullptr);
  }
  bodies_[free_.back()] = &body;
  body.setUserIndex3(static_cast<int>(free_.back()));
  free_.pop_back();
}

void SoftIslands::remove(const btRigidBody& body) {
  const std::uint32_t slot = slot_of(body);
  if (slot == 0) return;
  if (has(slot, kKept)) forget_sleepers();
  states_[slot] = 0;
  bodies_[slot] = nullptr;
  free_.push_back(slot);
}

void SoftIslands::forget_past() {
  std::fill(states_.begin() + 1, states_.end(), std::uint8_t{0});
  forget_sleepers();
}

void SoftIslands::call(std::span<btRigidBody* const> bodies) {
  awake_.clear();
  asleep_.clear();
  called_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i + kPrefetchDistance < bodies.size()) prefetch_flags(*bodies[i + kPrefetchDistance]);
    note(*bodies[i]);
  }
  if (knows_sleepers_) return;
  std::iota(parents_.begin(), parents_.end(), 0U);
  seams_of_sleepers_.clear();
}

void SoftIslands::note(btRigidBody& body) {
  const std::uint32_t slot = slot_of(body);
  const core::Block& block = place_of(body).block;
  const bool sleeps = !body.isActive();
  if (sleeps != has(slot, kKept) || (sleeps && blocks_[slot] != block)) forget_sleepers();
  blocks_[slot] = block;
  if (!sleeps) parents_[slot] = slot;
  if (is_asleep(body) && body.getDeactivationTime() == 0) called_.push_back(slot);
  (sleeps ? asleep_ : awake_).push_back(&body);
  const int before = has(slot, kSleeps) ? kSlept : 0;
  states_[slot] = static_cast<std::uint8_t>(before | (sleeps ? kSleeps | kKept : kMoves));
}

/// First slot of the part. Halves the path to it (union-find).
std::uint32_t SoftIslands::part_of(std::uint32_t slot) {
  while (parents_[slot] != slot) slot = parents_[slot] = parents_[parents_[slot]];
  return slot;
}

/// Puts two bodies that touch into one part, or notes in `seams` that they touch across a seam.
void SoftIslands::unite(std::uint32_t a, std::uint32_t b, std::vector<Seam>& seams) {
  if (a == 0 || b == 0) return;
  if (blocks_[a] != blocks_[b]) {
    seams.push_back({a, b});
    return;
  }
  wakes_any_ = wakes_any_ || sleeps(a) != sleeps(b);
  const std::uint32_t one = part_of(a), other = part_of(b);
  parents_[std::max(one, other)] = std::min(one, other);
}

void SoftIslands::find(std::span<const SoftTouch> touches, std::span<const SoftTouch> of_sleepers,
                       std::span<const std::uint32_t> parted, std::span<btTypedConstraint* const> joints) {
  wakes_any_ = false;
  seams_.clear();
  for (const SoftTouch& touch : touches) unite(touch.slot_a, touch.slot_b, seams_);
  for (const SoftTouch& touch : of_sleepers) unite(touch.slot_a, touch.slot_b, seams_of_sleepers_);
  for (const btTypedConstraint* joint : joints) {
    const std::uint32_t one = slot_of(joint->getRigidBodyA()), other = slot_of(joint->getRigidBodyB());
    const bool both_sleep = sleeps(one) && sleeps(other);
    if (!joint->isEnabled() || (both_sleep && knows_sleepers_)) continue;
    unite(one, other, both_sleep ? seams_of_sleepers_ : seams_);
  }
  mark_parts(parted);
  const bool knew = knows_sleepers_;
  knows_sleepers_ = true;
  put_to_sleep();
  has_woken_any_ = false;
  if (wakes_any_) wake();
  for (const Seam& seam : seams_) {
    if (!has(seam.a, kMoves) && !has(seam.b, kMoves)) seams_of_sleepers_.push_back(seam);
  }
  // Contacts ahead of time between bodies that now sleep do not join their parts.
  const auto stay = [this](const SoftTouch& touch) { return !has(touch.slot_a, kMoves) && !has(touch.slot_b, kMoves); };
  if (std::ranges::any_of(touches, [&](const SoftTouch& touch) { return touch.ahead && stay(touch); })) {
    forget_sleepers();
  }
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

void SoftIslands::mark_parts(std::span<const std::uint32_t> parted) {
  std::ranges::fill(parts_, std::uint8_t{0});
  for (const btRigidBody* body : awake_) {
    const std::uint32_t part = part_of(slot_of(*body));
    if (!wants_to_sleep(*body)) parts_[part] |= kUp;
    if (!is_calm(*body)) parts_[part] |= kStirs;
  }
  const auto touched_by = [this](std::uint32_t slot, std::uint32_t other) {
    if (!is(other, kStirs)) return;
    mark(slot, kTouched);
    wakes_any_ = wakes_any_ || sleeps(slot);
  };
  const auto look_across = [&touched_by](const Seam& seam) { touched_by(seam.a, seam.b), touched_by(seam.b, seam.a); };
  std::ranges::for_each(seams_, look_across);
  if (wakes_any_) std::ranges::for_each(seams_of_sleepers_, look_across);
  const auto call = [this](std::uint32_t slot) {
    mark(slot, kUp);
    wakes_any_ = true;
  };
  std::ranges::for_each(parted, call);
  std::ranges::for_each(called_, call);
}

void SoftIslands::put_to_sleep() {
  std::erase_if(awake_, [this](btRigidBody* body) {
    const std::uint32_t slot = slot_of(*body);
    if (is(slot, kUp | kTouched)) return false;
    body->setActivationState(ISLAND_SLEEPING);
    stop(*body);
    states_[slot] = static_cast<std::uint8_t>((states_[slot] & ~kMoves) | kKept);
    return true;
  });
}

/// Wakes the sleepers of parts that are awake. They stay awake for at least as long as a body has to be slow before it
/// sleeps, so that no part falls asleep and wakes by turns.
void SoftIslands::wake() {
  for (btRigidBody* body : asleep_) {
    const std::uint32_t slot = slot_of(*body);
    if (!is(slot, kUp | kTouched)) continue;
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
  std::erase_if(seams_of_sleepers_, [this](const Seam& seam) { return has(seam.a, kMoves) || has(seam.b, kMoves); });
}

void SoftIslands::rest(btScalar step_s) {
  for (btRigidBody* body : awake_) {
    const bool is_calm = !is(slot_of(*body), kStirs);
    body->updateDeactivation(step_s);
    if (body->getActivationState() == DISABLE_DEACTIVATION) continue;
    body->setActivationState(is_calm && is_still(*body) ? WANTS_DEACTIVATION : ACTIVE_TAG);
  }
  call_neighbours();
}

void SoftIslands::call_neighbours() {
  for (const SoftTouch& touch : touches_) {
    if (has(touch.slot_a, kMoves) == has(touch.slot_b, kMoves)) continue;
    const bool a_moves = has(touch.slot_a, kMoves);
    const btRigidBody* const moved = bodies_[a_moves ? touch.slot_a : touch.slot_b];
    btRigidBody* const other = bodies_[a_moves ? touch.slot_b : touch.slot_a];
    if (other == nullptr || !is_asleep(*other)) continue;  // a static, or disabled
    if (moved->getActivationState() != WANTS_DEACTIVATION) other->setDeactivationTime(0);
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
