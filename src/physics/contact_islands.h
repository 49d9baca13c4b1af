// Which bodies are solved and fall asleep together, and in which order the solver sees their contacts and joints.
// Neither may depend on what else is in the world.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

#include "physics/contact_cache.h"

class btCollisionWorld;
class btConstraintSolver;
class btTypedConstraint;
struct btContactSolverInfo;

namespace aurasim::physics {

/// Differs from Bullet's in four ways. Islands are joined by contacts, not by overlapping bounds, which remember the
/// past. The manifolds of an island are in the order of the bodies' user indices, then of their parts, its joints in
/// that of their user types. Islands are
/// never solved in one batch with others, because the solver stops early on the error of the whole batch. Nothing is
/// allocated once warm.
///
/// A body's user index grows with its id; a static's is negative.
class ContactIslands : public btSimulationIslandManager {
 public:
  /// Called by Bullet after collision detection.
  void updateActivationState(btCollisionWorld* world, btDispatcher* dispatcher) override;

  /// Puts islands to sleep or wakes them, then solves those that are awake.
  void solve(btCollisionWorld& world, std::span<btTypedConstraint* const> joints, btConstraintSolver& solver,
             const btContactSolverInfo& info);

 private:
  /// Sorted before the solver sees it.
  struct Entry {
    int island;
    std::uint64_t bodies;  ///< body0 and body1
    Parts parts;
    btPersistentManifold* manifold;
  };
  struct JointEntry {
    int island;
    int order;
    btTypedConstraint* joint;
  };

  /// Calls `visit(bodies, manifolds, joints)` for each island that is awake.
  template <class Visit>
  void for_each_awake(btCollisionWorld& world, std::span<btTypedConstraint* const> joints, Visit&& visit);
  void settle(btCollisionWorld& world, int first, int last);
  void collect_awake_manifolds(btDispatcher& dispatcher);
  void collect_awake_joints(std::span<btTypedConstraint* const> joints);
  int end_of_island(int first);

  std::vector<Entry> entries_;
  std::vector<btPersistentManifold*> manifolds_;  ///< as entries_
  std::vector<JointEntry> joint_entries_;
  std::vector<btTypedConstraint*> joints_;  ///< as joint_entries_
  std::vector<btCollisionObject*> island_;
  std::vector<btCollisionObject*> lonely_;  ///< awake bodies without any contact or joint
};

}  // namespace aurasim::physics
