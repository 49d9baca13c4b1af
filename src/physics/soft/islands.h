// Which bodies of a soft step are awake, and their contacts and joints, each island's in an order that follows from the
// island alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/touch.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

/// Bodies that touch or are joined fall asleep together, and wake together. What sleepers touch stays as it is until
/// one of them wakes, comes or goes, so a step asks each whether it still sleeps, and no more. A body's user index
/// grows with its id; a static's is negative. Nothing is allocated once warm.
class SoftIslands {
 public:
  /// A body that comes into the world gets a slot (its user index 3), which stays the same until it goes. 0: statics.
  void insert(btRigidBody& body);
  void remove(const btRigidBody& body);

  /// At the start of a step: who is awake?
  void call(std::span<btRigidBody* const> bodies);
  /// When it was called, and when it was called in the step before. Statics always do.
  bool sleeps(std::uint32_t slot) const { return has(slot, kSleeps); }
  bool slept(std::uint32_t slot) const { return has(slot, kSlept); }
  /// Which of them touch each other. If not, find() has to be shown it.
  bool knows_sleepers() const { return knows_sleepers_; }

  /// Puts islands to sleep or wakes them.
  void find(std::span<const SoftTouch> touches, std::span<const SoftTouch> of_sleepers,
            std::span<btTypedConstraint* const> joints);
  bool has_woken_any() const { return has_woken_any_; }
  /// Of one that slept when it was called.
  bool is_woken(std::uint32_t slot) const { return has(slot, kSleeps) && has(slot, kMoves); }

  /// Those of bodies that are awake now.
  void sort(std::span<const SoftTouch> touches);

  /// From call() on as it says, from find() on who moves in the step.
  std::span<btRigidBody* const> awake() const { return awake_; }
  /// Of bodies that are awake, once sorted. Ordered by the bodies' user indices, then by their parts.
  std::span<const SoftTouch> touches() const { return touches_; }
  /// Ordered by their user types.
  std::span<btTypedConstraint* const> joints() const { return joints_; }

 private:
  enum State : std::uint8_t {
    kSleeps = 1,
    kSlept = 2,
    kMoves = 4,  ///< in the step
    kKept = 8,   ///< its island is known since the step before
  };

  /// They may be connected in another way than before.
  void forget_sleepers() { knows_sleepers_ = false; }
  bool has(std::uint32_t slot, State state) const { return (states_[slot] & state) != 0; }
  std::uint32_t island_of(std::uint32_t slot);
  void unite(std::uint32_t a, std::uint32_t b);
  void put_to_sleep();
  void wake();

  std::vector<std::uint8_t> states_{kSleeps | kSlept | kKept};  ///< by slot, as all that follow
  std::vector<std::uint32_t> parents_{0};
  std::vector<std::uint8_t> is_active_{0};  ///< of an island's first: somebody in it does not want to sleep
  std::vector<std::uint32_t> free_;
  bool knows_sleepers_ = true;
  bool reaches_sleepers_ = false;  ///< somebody who is awake
  bool has_woken_any_ = false;
  std::vector<btRigidBody*> awake_;
  std::vector<btRigidBody*> asleep_;  ///< when they were called
  std::vector<SoftTouch> touches_;
  std::vector<std::uint32_t> ends_;  ///< of the touches of a body, by user index
  std::vector<btTypedConstraint*> joints_;
};

}  // namespace aurasim::physics
