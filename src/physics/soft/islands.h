// Which bodies of a soft step are awake, and their contacts and joints, each island's in an order that follows from the
// island alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/contacts.h"

class btRigidBody;
class btTypedConstraint;

namespace aurasim::physics {

/// Bodies that touch or are joined fall asleep together, and wake together. A body's user index grows with its id; a
/// static's is negative. Nothing is allocated once warm.
class SoftIslands {
 public:
  /// Puts islands to sleep or wakes them.
  void find(std::span<btRigidBody* const> bodies, std::span<const SoftTouch> touches,
            std::span<btTypedConstraint* const> joints);

  std::span<btRigidBody* const> awake() const { return awake_; }
  /// Of bodies that are awake. Ordered by the bodies' user indices, then by their parts.
  std::span<SoftTouch> touches() { return touches_; }
  /// Ordered by their user types.
  std::span<btTypedConstraint* const> joints() const { return joints_; }

 private:
  std::uint32_t island_of(std::uint32_t body);
  void unite(int a, int b);
  void settle(std::span<btRigidBody* const> bodies);
  void sort(std::span<const SoftTouch> touches);

  std::vector<std::uint32_t> parents_;  ///< by user index
  std::vector<std::uint8_t> states_;    ///< by user index of an island's first body: who is awake in it
  std::vector<std::uint8_t> is_awake_;  ///< by user index
  std::vector<SoftTouch> touches_;
  std::vector<std::uint32_t> ends_;  ///< of the touches of a body, by user index
  std::vector<btRigidBody*> awake_;
  std::vector<btTypedConstraint*> joints_;
};

}  // namespace aurasim::physics
