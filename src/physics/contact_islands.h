// Contact islands: bodies that are solved and fall asleep together, and the order of their contacts and joints for the
// solver. Neither may depend on what else is in the world.
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

/// Differs from Bullet's manager in four ways. (1) Islands are joined by contacts, not by overlapping bounds, which
/// depend on the past. (2) The manifolds of an island are ordered by the bodies' user indices, then by their parts; its
/// joints by their user types. (3) Each island is solved alone, because the solver stops early on the error of a whole
/// batch. (4) Nothing is allocated once warm.
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
  /// A manifold with its sort key.
  struct Entry {
    int island;
    std::uint64_t bodies;  ///< user indices of body0 and body1, packed into one key
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
  std::vector<btPersistentManifold*> manifolds_;  ///< by entry of entries_
  std::vector<JointEntry> joint_entries_;
  std::vector<btTypedConstraint*> joints_;  ///< by entry of joint_entries_
  std::vector<btCollisionObject*> island_;
  std::vector<btCollisionObject*> lonely_;  ///< awake bodies without any contact or joint
};

}  // namespace aurasim::physics
