#include "physics/soft/islands.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/used_room.h"
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

/// Is it a sleeper that wakes in the next step?
bool is_called(const btRigidBody& body) { return is_asleep(body) && body.getDeactivationTime() == 0; }

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
    parents_.push_back(free_.back()), next_.push_back(free_.back());
    states_.push_back(0), parts_.push_back(0), urges_.push_back(0), entries_.emplace_back();
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  body.setUserIndex3(static_cast<int>(slot));
  entries_[slot].body = &body;
  entries_[slot].is_guest = physics::is_guest(body);
  if (entries_[slot].is_guest) guests_.push_back(&body);
  place_of(body).changes = &changes_;
  changes_.push_back(slot);
}

void SoftIslands::remove(btRigidBody& body) {
  const std::uint32_t slot = slot_of(body);
  if (slot == 0) return;
  unlist(slot);
  dissolve(slot);
  states_[slot] = 0;
  if (entries_[slot].is_guest) std::erase(guests_, &body);
  entries_[slot].body = nullptr;
  place_of(body).changes = nullptr;
  free_.push_back(slot);
}

void SoftIslands::forget_past() {
  std::fill(states_.begin() + 1, states_.end(), std::uint8_t{0});
  std::iota(parents_.begin(), parents_.end(), 0U);
  std::iota(next_.begin(), next_.end(), 0U);
  seams_of_sleepers_.clear();
  for (auto* list : {&called_, &changes_, &forgotten_}) list->clear();
  for (std::uint32_t slot = 1; slot < entries_.size(); ++slot) changes_.push_back(slot);
}

void SoftIslands::free_spare_memory() {
  touches_ = {};
  core::free_memory(order_, notes_);
  seams_.shrink_to_fit();
  for (auto* list : {&called_, &changes_, &settling_, &marked_, &forgotten_, &found_}) list->shrink_to_fit();
  awake_.shrink_to_fit();
}

void SoftIslands::unlist(std::uint32_t slot) {
  if (std::exchange(entries_[slot].list, List::kNone) != List::kAwake) return;
  btRigidBody* const last = awake_.back();
  awake_[entries_[slot].place] = last;
  entries_[slot_of(*last)].place = entries_[slot].place;
  awake_.pop_back();
  is_in_order_ = false;
}

void SoftIslands::put_into(List list, std::uint32_t slot) {
  Entry& entry = entries_[slot];
  if (entry.list != list) {
    unlist(slot);
    entry.list = list;
    if (list == List::kAwake) {
      entry.place = static_cast<std::uint32_t>(awake_.size());
      awake_.push_back(entry.body);
      is_in_order_ = false;
    }
  }
  if (list != List::kAsleep || entry.settles) return;
  entry.settles = true;
  settling_.push_back(slot);
}

/// The touches of a sleeper are not known any more. Its seams are among them.
void SoftIslands::forget(std::uint32_t slot) {
  drop_seams(slot);
  if (has(slot, kForgotten)) return;
  states_[slot] |= kForgotten;
  forgotten_.push_back(slot);
}

/// Takes the part of a body apart, and forgets what its sleepers touch.
void SoftIslands::dissolve(std::uint32_t slot) {
  drop_seams(slot);
  if (next_[slot] == slot) return;
  for_each_of_part(slot, [this](std::uint32_t of_part) {
    parents_[of_part] = next_[of_part] = of_part;
    if (entries_[of_part].list == List::kAsleep) forget(of_part);
  });
}

void SoftIslands::drop_seams(std::uint32_t slot) {
  while (seams_of_sleepers_.has(slot)) seams_of_sleepers_.take(seams_of_sleepers_.first(slot) / 2);
}

void SoftIslands::call(soft::Team& team) {
  for (const std::uint32_t slot : changes_) {
    if (btRigidBody* const body = entries_[slot].body) put_into(body->isActive() ? List::kAwake : List::kAsleep, slot);
  }
  changes_.clear();
  if (!is_in_order_) put_in_order();
  notes_.resize(awake_.size());
  team.side_by_side([this](const soft::Worker& worker) {
    const auto [first, last] = worker.share(awake_.size());
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPrefetchDistance < last) prefetch_flags(*awake_[i + kPrefetchDistance]);
      notes_[i] = look_for_changes(*awake_[i]);
    }
  });
  for (const Note& of : notes_) note(of);
  std::erase_if(settling_, [this](std::uint32_t slot) {
    Entry& entry = entries_[slot];
    if (entry.list == List::kAsleep) note(look_for_changes(*entry.body));
    entry.settles = entry.list == List::kAsleep && !has(slot, kSlept);
    return !entry.settles;
  });
}

/// Puts the awake bodies in the order of their slots, as they mostly lie in memory.
void SoftIslands::put_in_order() {
  constexpr std::size_t kMany = 16;  // slots for each awake body
  order_.clear();
  if (kMany * awake_.size() < entries_.size()) {
    for (const btRigidBody* body : awake_) order_.push_back(slot_of(*body));
    std::ranges::sort(order_);
  } else {
    for (std::uint32_t slot = 1; slot < entries_.size(); ++slot) {
      if (entries_[slot].list == List::kAwake) order_.push_back(slot);
    }
  }
  for (std::size_t i = 0; i < order_.size(); ++i) {
    awake_[i] = entries_[order_[i]].body;
    entries_[order_[i]].place = static_cast<std::uint32_t>(i);
  }
  is_in_order_ = true;
}

/// Looks at a body. Several threads may look at different ones.
SoftIslands::Note SoftIslands::look_for_changes(const btRigidBody& body) {
  const std::uint32_t slot = slot_of(body);
  const core::Block& block = place_of(body).block;
  const bool is_kept = has(slot, kKept) && entries_[slot].block == block;
  entries_[slot].block = block;
  return {slot, !body.isActive(), is_kept, is_called(body)};
}

/// Brings what is known of a body up to date. Sleepers are skipped once nothing of it changes any more.
void SoftIslands::note(const Note& of) {
  if (!of.sleeps || !of.is_kept) dissolve(of.slot);
  if (of.sleeps && !of.is_kept) forget(of.slot);
  if (of.is_called) called_.push_back(of.slot);
  const int before = (has(of.slot, kSleeps) ? kSlept : 0) | (states_[of.slot] & kForgotten);
  states_[of.slot] = static_cast<std::uint8_t>(before | (of.sleeps ? kSleeps | kKept : kMoves));
}

/// First slot of the part. Halves the path to it (union-find).
std::uint32_t SoftIslands::part_of(std::uint32_t slot) {
  while (parents_[slot] != slot) slot = parents_[slot] = parents_[parents_[slot]];
  return slot;
}

/// Puts two bodies that touch into one part. Returns false with nothing done if they touch across a seam.
bool SoftIslands::unite(std::uint32_t a, std::uint32_t b) {
  if (a == 0 || b == 0) return true;
  if (entries_[a].block != entries_[b].block) return false;
  wakes_any_ = wakes_any_ || sleeps(a) != sleeps(b);
  const std::uint32_t one = part_of(a), other = part_of(b);
  if (one == other) return true;
  parents_[std::max(one, other)] = std::min(one, other);
  std::swap(next_[one], next_[other]);  // joins the two rings
  return true;
}

void SoftIslands::unite_awake(std::uint32_t a, std::uint32_t b) {
  if (!unite(a, b)) seams_.push_back({a, b});
}

void SoftIslands::unite_asleep(std::uint32_t a, std::uint32_t b) {
  if (!unite(a, b)) seams_of_sleepers_.add(a, b, {});
}

void SoftIslands::look_at(const btRigidBody& awake) {
  const std::uint32_t slot = slot_of(awake);
  const bool is_guest = entries_[slot].is_guest;  // the region that hosts it decides
  urges_[slot] = static_cast<std::uint8_t>((is_guest || wants_to_sleep(awake) ? 0 : kUp) |
                                           (is_guest || is_calm(awake) ? 0 : kStirs));
}

void SoftIslands::find_parts(std::span<const SoftTouch> touches, std::span<const SleepersTouch> of_sleepers,
                             std::span<const ListedJoint> joints) {
  wakes_any_ = false;
  seams_.clear();
  for (const SoftTouch& touch : touches) unite_awake(touch.slot_a, touch.slot_b);
  for (const SleepersTouch& touch : of_sleepers) unite_asleep(touch.slot_a, touch.slot_b);
  for (const ListedJoint& joint : joints) {
    if (!joint.acts) continue;
    const std::uint32_t one = joint.slot_a, other = joint.slot_b;
    if (!sleeps(one) || !sleeps(other)) {
      unite_awake(one, other);
    } else if (is_forgotten(one) || is_forgotten(other)) {
      unite_asleep(one, other);
    }
  }
  mark_parts();
}

void SoftIslands::settle(std::span<const SoftTouch> touches, std::span<const std::uint32_t> parted) {
  look_across(parted);
  std::swap(found_, forgotten_);
  forgotten_.clear();
  for (const std::uint32_t slot : found_) states_[slot] = static_cast<std::uint8_t>(states_[slot] & ~kForgotten);
  put_to_sleep();
  has_woken_any_ = false;
  if (wakes_any_) wake();
  for (const Seam& seam : seams_) {
    if (!has(seam.a, kMoves) && !has(seam.b, kMoves)) seams_of_sleepers_.add(seam.a, seam.b, {});
  }
  // Contacts ahead of time between bodies that now sleep do not join their parts.
  for (const SoftTouch& touch : touches) {
    if (!touch.ahead || has(touch.slot_a, kMoves) || has(touch.slot_b, kMoves)) continue;
    for (const std::uint32_t slot : {touch.slot_a, touch.slot_b}) {
      if (slot == 0) continue;
      dissolve(slot);
      forget(slot);
    }
  }
  for (const std::uint32_t slot : found_) {
    if (entries_[slot].list == List::kAsleep && is_asleep(*entries_[slot].body)) stop(*entries_[slot].body);
  }
}

void SoftIslands::mark(std::uint32_t slot, int what) {
  const std::uint32_t part = part_of(slot);
  if (parts_[part] == 0) marked_.push_back(part);
  parts_[part] = static_cast<std::uint8_t>(parts_[part] | what);
}

void SoftIslands::mark_parts() {
  for (const std::uint32_t part : marked_) parts_[part] = 0;
  marked_.clear();
  for (const btRigidBody* body : awake_) {
    const std::uint32_t slot = slot_of(*body);
    if (urges_[slot] != 0) mark(slot, urges_[slot]);
  }
}

bool SoftIslands::is_sleepy(std::uint32_t slot) const { return sleeps(slot) || wants_to_sleep(*entries_[slot].body); }

void SoftIslands::note_stirs(std::uint32_t guest) {
  mark(guest, kStirs);
  wakes_any_ = true;
}

void SoftIslands::look_across(std::span<const std::uint32_t> parted) {
  const auto touched_by = [this](std::uint32_t slot, std::uint32_t other) {
    if (!is(other, kStirs)) return;
    mark(slot, kTouched);
    wakes_any_ = wakes_any_ || sleeps(slot);
  };
  const auto look_across = [&touched_by](const Seam& seam) { touched_by(seam.a, seam.b), touched_by(seam.b, seam.a); };
  std::ranges::for_each(seams_, look_across);
  // Only sleepers of a part that an awake body has just joined can stir.
  for (std::size_t i = 0, count = wakes_any_ ? marked_.size() : 0; i < count; ++i) {
    if ((parts_[marked_[i]] & kStirs) == 0) continue;
    for_each_of_part(marked_[i], [&](std::uint32_t slot) {
      for_each_seam_of_sleeper(slot, [&](std::uint32_t other) { touched_by(other, slot); });
    });
  }
  const auto call = [this](std::uint32_t slot) {
    mark(slot, kUp);
    wakes_any_ = true;
  };
  std::ranges::for_each(parted, call);
  for (const std::uint32_t slot : called_) {
    if (entries_[slot].body != nullptr && is_called(*entries_[slot].body)) call(slot);
  }
  called_.clear();
}

void SoftIslands::put_to_sleep() {
  for (std::size_t i = 0; i < awake_.size();) {
    btRigidBody& body = *awake_[i];
    const std::uint32_t slot = slot_of(body);
    if (entries_[slot].is_guest || is(slot, kUp | kTouched)) {
      ++i;
      continue;
    }
    body.setActivationState(ISLAND_SLEEPING);
    stop(body);
    states_[slot] = static_cast<std::uint8_t>((states_[slot] & ~kMoves) | kKept);
    put_into(List::kAsleep, slot);  // another body takes its place in the list
  }
}

/// Wakes the sleepers of parts that are awake. They stay awake for at least as long as a body has to be slow before it
/// sleeps, so that no part falls asleep and wakes by turns.
void SoftIslands::wake() {
  const auto wake = [this](std::uint32_t slot) {
    const Entry& entry = entries_[slot];
    if (entry.list != List::kAsleep || entry.is_guest || !is_asleep(*entry.body)) return;  // the last: disabled
    entry.body->setActivationState(WANTS_DEACTIVATION);
    entry.body->setDeactivationTime(0);
    states_[slot] = static_cast<std::uint8_t>((states_[slot] & ~kKept) | kMoves);
    drop_seams(slot);
    put_into(List::kAwake, slot);
    has_woken_any_ = true;
  };
  for (const std::uint32_t part : marked_) {
    if ((parts_[part] & (kUp | kTouched)) != 0) for_each_of_part(part, wake);
  }
}

void SoftIslands::rest(btScalar step_s, soft::Team& team) {
  team.for_each(awake_.size(), [&](std::size_t i) { rest(*awake_[i], step_s); });
  call_neighbours();
}

/// Writes nothing but the body, so threads may share the bodies.
void SoftIslands::rest(btRigidBody& body, btScalar step_s) const {
  if (entries_[slot_of(body)].is_guest) return;
  body.updateDeactivation(step_s);
  if (body.getActivationState() == DISABLE_DEACTIVATION) return;
  std::uint32_t part = slot_of(body);
  while (parents_[part] != part) part = parents_[part];
  const bool is_calm = (parts_[part] & kStirs) == 0 && is_still(body);
  body.setActivationState(is_calm ? WANTS_DEACTIVATION : ACTIVE_TAG);
}

void SoftIslands::call_neighbours() {
  for (const SoftTouch& touch : touches_.all()) {
    const bool a_moves = has(touch.slot_a, kMoves);
    if (a_moves == has(touch.slot_b, kMoves)) continue;
    const Entry& moved = entries_[a_moves ? touch.slot_a : touch.slot_b];
    const std::uint32_t slot = a_moves ? touch.slot_b : touch.slot_a;
    if (moved.is_guest || entries_[slot].is_guest) continue;
    if (moved.body->getActivationState() != WANTS_DEACTIVATION) call(slot);
  }
}

void SoftIslands::call(std::uint32_t sleeper) {
  btRigidBody* const body = entries_[sleeper].body;
  if (body == nullptr || !is_asleep(*body) || is_called(*body)) return;  // a static, disabled, or done
  body->setDeactivationTime(0);
  called_.push_back(sleeper);
}

void SoftIslands::decide(btRigidBody& guest, bool moves) {
  const std::uint32_t slot = slot_of(guest);
  if (has(slot, kMoves) == moves) return;
  states_[slot] = static_cast<std::uint8_t>(moves ? states_[slot] | kMoves : states_[slot] & ~kMoves);
  put_into(moves ? List::kAwake : List::kAsleep, slot);
}

}  // namespace aurasim::physics
