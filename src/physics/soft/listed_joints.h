// The joints of a world, as a step needs them before it solves them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/prefetch.h"
#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

namespace aurasim::physics {

struct ListedJoint {
  btTypedConstraint* joint = nullptr;
  std::uint32_t slot_a = 0, slot_b = 0;  ///< of its bodies
  int order = 0;
  bool acts = false;
};

/// Joints and their bodies are scattered in memory, so each is looked at once, by all threads.
class ListedJoints {
 public:
  void look(std::span<btTypedConstraint* const> joints, soft::Team& team) {
    all_.resize(joints.size());
    team.side_by_side([&](const soft::Worker& worker) {
      const auto [first, last] = worker.share(joints.size());
      for (std::size_t i = first; i < last; ++i) {
        if (i + kPrefetchDistance < last) prefetch(joints[i + kPrefetchDistance], sizeof(btTypedConstraint));
        if (i + kPrefetchDistance / 2 < last) {
          const btTypedConstraint& soon = *joints[i + kPrefetchDistance / 2];
          prefetch_flags(soon.getRigidBodyA()), prefetch_flags(soon.getRigidBodyB());
        }
        btTypedConstraint& joint = *joints[i];
        all_[i] = {&joint, slot_of(joint.getRigidBodyA()), slot_of(joint.getRigidBodyB()),
                   joint.getUserConstraintType(), joint.isEnabled()};
      }
    });
  }
  std::span<const ListedJoint> all() const { return all_; }

  /// Takes the joints that act on a body that moves in the step: moves(slot).
  template <class Moves>
  void sort(Moves&& moves) {
    const auto acts = [&moves](const ListedJoint& of) { return of.acts && (moves(of.slot_a) || moves(of.slot_b)); };
    moving_.clear();
    std::ranges::copy_if(all_, std::back_inserter(moving_), acts);
    if (!std::ranges::is_sorted(moving_, {}, &ListedJoint::order)) {
      std::ranges::sort(moving_, {}, &ListedJoint::order);
    }
    sorted_.clear();
    for (const ListedJoint& of : moving_) sorted_.push_back(of.joint);
  }
  /// They, in an order that follows from the bodies alone.
  std::span<btTypedConstraint* const> sorted() const { return sorted_; }

 private:
  std::vector<ListedJoint> all_, moving_;
  std::vector<btTypedConstraint*> sorted_;
};

}  // namespace aurasim::physics
