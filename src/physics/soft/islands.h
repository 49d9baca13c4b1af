// The islands of a soft step: finds the bodies that are awake, and sorts their contacts and joints in an order that
// follows from each island alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

/// Bodies that touch or are jointed fall asleep and wake together. The touches of sleepers stay until one of them
/// wakes, arrives or leaves, so a step only tests whether each still sleeps. A body's user index grows with its id; a
/// static's is negative. Nothing is allocated once warm.
class SoftIslands {
 public:
  /// Gives a body that enters the world a slot (its user index 3), which stays the same until it leaves. Slot 0:
  /// statics.
  void insert(btRigidBody& body);
  void remove(const btRigidBody& body);

  /// Forgets which bodies slept, as if all of them had just entered the world.
  void forget_past();

  /// Finds the awake bodies at the start of a step.
  void call(std::span<btRigidBody* const> bodies);
  /// Did the body sleep at the last call(), and at the one in the step before? Always true for statics.
  bool sleeps(std::uint32_t slot) const { return has(slot, kSleeps); }
  bool slept(std::uint32_t slot) const { return has(slot, kSlept); }
  /// Are the touches of sleepers known? If not, find() has to get them as `of_sleepers`.
  bool knows_sleepers() const { return knows_sleepers_; }

  /// Puts islands to sleep or wakes them.
  void find(std::span<const SoftTouch> touches, std::span<const SoftTouch> of_sleepers,
            std::span<btTypedConstraint* const> joints);
  bool has_woken_any() const { return has_woken_any_; }
  /// Did the body sleep at call(), and was it woken by find()?
  bool is_woken(std::uint32_t slot) const { return has(slot, kSleeps) && has(slot, kMoves); }

  /// Sorts the touches of bodies that are awake now.
  void sort(std::span<const SoftTouch> touches, soft::Team& team);

  /// After call(): bodies that did not sleep. After find(): bodies that move in the step.
  std::span<btRigidBody* const> awake() const { return awake_; }
  /// Touches of awake bodies, after sort(). Ordered by the bodies' user indices, then by their parts.
  std::span<const SoftTouch> touches() const { return touches_; }
  /// Joints of awake bodies, ordered by their user types.
  std::span<btTypedConstraint* const> joints() const { return joints_; }

 private:
  enum State : std::uint8_t {
    kSleeps = 1,
    kSlept = 2,
    kMoves = 4,  ///< it moves in the step
    kKept = 8,   ///< it sleeps, and the touches of its island are known
  };

  /// Call when the touches of sleepers may have changed.
  void forget_sleepers() { knows_sleepers_ = false; }
  bool has(std::uint32_t slot, State state) const { return (states_[slot] & state) != 0; }
  std::uint32_t island_of(std::uint32_t slot);
  void unite(std::uint32_t a, std::uint32_t b);
  void put_to_sleep();
  void wake();

  std::vector<std::uint8_t> states_{kSleeps | kSlept | kKept};  ///< by slot, as the following vectors
  std::vector<std::uint32_t> parents_{0};
  std::vector<std::uint8_t> is_active_{0};  ///< by first slot of an island: a body of it does not want to sleep
  std::vector<std::uint32_t> free_;
  bool knows_sleepers_ = true;
  bool reaches_sleepers_ = false;  ///< an awake body touches a sleeper
  bool has_woken_any_ = false;
  std::vector<btRigidBody*> awake_;
  std::vector<btRigidBody*> asleep_;  ///< bodies that slept at call()
  std::vector<SoftTouch> touches_;
  std::vector<std::uint32_t> ends_;  ///< by user index: end of the body's touches
  std::vector<btTypedConstraint*> joints_;
};

}  // namespace aurasim::physics
