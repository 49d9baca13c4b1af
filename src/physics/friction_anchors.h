// Friction anchors keep piles from creeping: contacts that stick remember how far they have slid all the same, and
// friction pulls them back.
//
// A solver that stops after a few iterations leaves a little speed at every contact, always in the same direction where
// a load leans. Bullet's friction looks at speeds only, so a pile that never sleeps walks away from under its load.
// Bullet's own friction anchors keep the first point of contact, which stops balls that should roll; here the
// way is counted from the speed at the contact, so that rolling adds nothing to it.
#pragma once

#include <vector>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

class btManifoldPoint;
struct btContactSolverInfo;

namespace aurasim::physics {

/// The rows of an island as Bullet's solver keeps them.
struct ContactRows {
  btConstraintArray& contacts;
  btConstraintArray& friction;
  btAlignedObjectArray<btSolverBody>& bodies;
};

/// The way is kept in the contact points (contact_cache.h, columns 30 and 31), so it moves with a hand-off.
class FrictionAnchors {
 public:
  /// Once the rows are made.
  void pull_back(const ContactRows& rows, const btContactSolverInfo& info);
  /// Once they are solved; the rows are still those of pull_back.
  void measure(const ContactRows& rows, const btContactSolverInfo& info);
  /// Once Bullet has written its results into the points.
  void remember();

 private:
  /// Of one contact: its way, and two directions across the normal that depend on nothing else.
  struct Of {
    btManifoldPoint* point = nullptr;
    btVector3 first;
    btVector3 second;
    btVector3 way;
  };
  std::vector<Of> contacts_;  ///< as ContactRows::contacts
};

}  // namespace aurasim::physics
