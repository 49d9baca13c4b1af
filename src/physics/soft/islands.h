// Sleep in the soft step (docs/design.md, "Sleep"): finds the bodies that are awake, and sorts their contacts in an
// order that follows from the bodies alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btScalar.h>

#include "core/block.h"
#include "physics/pair_lists.h"
#include "physics/soft/listed_joints.h"
#include "physics/soft/sorted_touches.h"
#include "physics/soft/touch.h"

namespace aurasim::physics {

/// A *part* is a set of bodies of one block that contacts and joints connect. It falls asleep and wakes as a whole.
/// Of what touches it across a seam of blocks, only counts whether its part stirs. That follows from the other block
/// alone. Bullet's activation state WANTS_DEACTIVATION means here: the body is still, and its part did not stir in the
/// step that led to this state. A sleeper with deactivation time 0 wakes in the next step.
///
/// A step costs nothing for a sleeper. What it touches is known until a body of its part wakes, leaves, or is given
/// another block; then only the touches of that part are found again. Whoever changes the activation state or the block
/// of a body from outside says so (note_change() in moving_body.h). A body's user index grows with its id; a static's
/// is negative. Nothing is allocated once warm.
class SoftIslands {
 public:
  SoftIslands() = default;
  SoftIslands(const SoftIslands&) = delete;  // bodies know changes_
  SoftIslands& operator=(const SoftIslands&) = delete;

  /// Gives a body that enters the world a slot (its user index 3), which stays the same until it leaves. Slot 0:
  /// statics.
  void insert(btRigidBody& body);
  void remove(btRigidBody& body);

  /// Forgets which bodies slept, as if all of them had just entered the world.
  void forget_past();

  /// Frees the memory of lists that a step makes anew. Call before call() or right after it.
  void free_spare_memory();

  /// Finds the awake bodies at the start of a step.
  void call(soft::Team& team);
  /// Did the body sleep at the last call(), and at the one in the step before? Always true for statics.
  bool sleeps(std::uint32_t slot) const { return has(slot, kSleeps); }
  bool slept(std::uint32_t slot) const { return has(slot, kSlept); }
  /// Sleepers whose touches are not known: find_parts() has to get those of them with other sleepers. Some of these
  /// slots may be awake or free.
  std::span<const std::uint32_t> forgotten() const { return forgotten_; }
  bool is_forgotten(std::uint32_t slot) const { return has(slot, kForgotten); }

  /// After call(): nobody is awake, and nothing has to be found out about sleepers.
  bool are_at_rest() const { return awake_.empty() && forgotten_.empty(); }

  /// Looks at how an awake body moves. Call for all of them after call(); several threads may, for different bodies.
  void look_at(const btRigidBody& awake);

  /// Finds the parts, and which of them stir.
  void find_parts(std::span<const SoftTouch> touches, std::span<const SleepersTouch> of_sleepers,
                  std::span<const ListedJoint> joints);
  /// Puts parts to sleep or wakes them. `parted`: slots of sleepers that have lost the touch of a body that is awake.
  void settle(std::span<const SoftTouch> touches, std::span<const std::uint32_t> parted);

  // Where regions are coupled, each region decides about the bodies that it hosts. Between find_parts() and settle():
  /// Calls visit(slot, slot) for each two bodies of two blocks that touch, unless both sleep and none is a guest. Some
  /// pairs come more than once.
  template <class Visit>
  void for_each_seam(Visit&& visit) const {
    for (const Seam& seam : seams_) visit(seam.a, seam.b);
    for (const btRigidBody* guest : guests_) {
      const std::uint32_t slot = slot_of(*guest);
      for_each_seam_of_sleeper(slot, [&](std::uint32_t other) { visit(slot, other); });
    }
  }
  /// Does it matter to the body whether what touches it stirs?
  bool is_sleepy(std::uint32_t slot) const;
  bool stirs(std::uint32_t slot) { return is(slot, kStirs); }
  /// The part of a guest stirs.
  void note_stirs(std::uint32_t guest);
  // After settle():
  /// Does the body move in the step, as far as this region knows?
  bool moves(std::uint32_t slot) const { return has(slot, kMoves); }
  bool is_guest(std::uint32_t slot) const { return entries_[slot].is_guest; }
  std::span<btRigidBody* const> guests() const { return guests_; }
  /// Above all slots.
  std::size_t slots() const { return entries_.size(); }
  /// Makes a guest move in the step or not, as its host has decided.
  void decide(btRigidBody& guest, bool moves);
  // After rest():
  /// Calls a sleeper that a guest has touched.
  void call(std::uint32_t sleeper);

  /// Sorts the touches of bodies that are awake now.
  void sort(std::span<const SoftTouch> touches, soft::Team& team) {
    touches_.sort(
        touches, [this](std::uint32_t slot) { return moves(slot); }, team);
  }

  bool has_woken_any() const { return has_woken_any_; }
  /// Did the body sleep at call(), and was it woken by find()?
  bool is_woken(std::uint32_t slot) const { return has(slot, kSleeps) && has(slot, kMoves); }

  /// Gives the bodies that have moved in the step their activation states, after their velocities are known. Sleepers
  /// that one of them has touched across a seam are called, unless it is calm: they wake in the next step.
  void rest(btScalar step_s, soft::Team& team);
  /// After rest(): slots of the sleepers that it has called. Their deactivation times have changed.
  std::span<const std::uint32_t> called() const { return called_; }
  const btRigidBody& body_at(std::uint32_t slot) const { return *entries_[slot].body; }

  /// After call(): bodies that did not sleep. After find(): bodies that move in the step.
  std::span<btRigidBody* const> awake() const { return awake_; }
  /// Touches of awake bodies, after sort().
  std::span<const SoftTouch> touches() const { return touches_.all(); }

 private:
  enum State : std::uint8_t {
    kSleeps = 1,
    kSlept = 2,
    kMoves = 4,       ///< it moves in the step
    kKept = 8,        ///< it sleeps, and its touches are known or it is in forgotten_
    kForgotten = 16,  ///< it is in forgotten_
  };
  /// Of a part.
  enum Part : std::uint8_t {
    kUp = 1,       ///< a body of it does not want to sleep, or a sleeper of it is called
    kStirs = 2,    ///< a body of it is not calm
    kTouched = 4,  ///< a body of a part that stirs touches it across a seam
  };

  enum class List : std::uint8_t { kNone, kAwake, kAsleep };
  struct Entry {
    btRigidBody* body = nullptr;
    core::Block block{0, 0};
    std::uint32_t place = 0;  ///< in awake_, if it is there
    List list = List::kNone;  ///< kAsleep: it sleeps, or is disabled
    bool settles = false;     ///< it is in settling_
    bool is_guest = false;
  };
  /// Slots of two bodies of two blocks that touch.
  struct Seam {
    std::uint32_t a, b;
  };

  struct Nothing {};
  /// State of a body at the start of a step, as call() finds it.
  struct Note {
    std::uint32_t slot;
    bool sleeps;
    bool is_kept;  ///< it was kKept, and its block is the same
    bool is_called;
  };

  void forget(std::uint32_t slot);
  void dissolve(std::uint32_t slot);
  void drop_seams(std::uint32_t slot);
  template <class Visit>
  void for_each_seam_of_sleeper(std::uint32_t slot, Visit&& visit) const {
    for (std::uint32_t link = seams_of_sleepers_.first(slot); link != PairLists<Nothing>::kNone;
         link = seams_of_sleepers_.next(link)) {
      visit(seams_of_sleepers_.other(link));
    }
  }
  /// Calls visit(slot) for the bodies of a part.
  template <class Visit>
  void for_each_of_part(std::uint32_t slot, Visit&& visit) const {
    std::uint32_t of_part = slot;
    do {
      const std::uint32_t next = next_[of_part];
      visit(of_part);
      of_part = next;
    } while (of_part != slot);
  }
  bool has(std::uint32_t slot, State state) const { return (states_[slot] & state) != 0; }
  Note look_for_changes(const btRigidBody& body);
  void note(const Note& of);
  void unlist(std::uint32_t slot);
  void put_into(List list, std::uint32_t slot);
  void put_in_order();
  std::uint32_t part_of(std::uint32_t slot);
  void mark(std::uint32_t slot, int what);
  bool is(std::uint32_t slot, int what) { return (parts_[part_of(slot)] & what) != 0; }
  bool unite(std::uint32_t a, std::uint32_t b);
  void unite_awake(std::uint32_t a, std::uint32_t b);
  void unite_asleep(std::uint32_t a, std::uint32_t b);
  void mark_parts();
  void look_across(std::span<const std::uint32_t> parted);
  void put_to_sleep();
  void wake();
  void rest(btRigidBody& body, btScalar step_s) const;
  void call_neighbours();

  std::vector<std::uint8_t> states_{kSleeps | kSlept | kKept};  ///< by slot, as the following vectors
  std::vector<std::uint32_t> parents_{0};
  std::vector<std::uint32_t> next_{0};  ///< the next body of the same part, around
  std::vector<std::uint8_t> parts_{0};  ///< flags Part, by the first slot of a part
  std::vector<std::uint8_t> urges_{0};  ///< flags Part that a body gives its part, if it is awake
  std::vector<Entry> entries_{1};
  std::vector<std::uint32_t> free_;
  std::vector<Seam> seams_;                       ///< with a body that was awake at call()
  PairLists<Nothing> seams_of_sleepers_;          ///< with two sleepers
  std::vector<std::uint32_t> called_;             ///< sleepers that are to wake
  std::vector<std::uint32_t> changes_;            ///< slots of bodies that have come or were changed from outside
  std::vector<std::uint32_t> settling_;           ///< sleepers whose flags may still change
  std::vector<std::uint32_t> marked_;             ///< parts with flags
  std::vector<std::uint32_t> forgotten_, found_;  ///< sleepers whose touches are not known; those found in this step
  std::vector<std::uint32_t> order_;              ///< space for put_in_order()
  std::vector<Note> notes_;                       ///< of the awake bodies
  bool is_in_order_ = true;
  bool wakes_any_ = false;
  bool has_woken_any_ = false;
  std::vector<btRigidBody*> awake_;
  std::vector<btRigidBody*> guests_;
  SortedTouches touches_;
};

}  // namespace aurasim::physics
