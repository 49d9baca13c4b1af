// Friction anchors keep piles from creeping: contacts that stick remember how far they have slid all the same, and
// friction pulls them back.
//
// A solver that stops after a few iterations leaves a little speed at every contact, always in the same direction where
// a load leans. Bullet's friction looks at speeds only, so a pile that never sleeps walks away from under its load.
// Bullet's own friction anchors keep the first point of contact, which stops balls that should roll. Here the way is
// summed from the speed at the contact, so rolling adds nothing to it.
#pragma once

#include <vector>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

class btManifoldPoint;
struct btContactSolverInfo;

namespace aurasim::physics {

/// The solver's rows of an island.
struct ContactRows {
  btConstraintArray& contacts;
  btConstraintArray& friction;
  btAlignedObjectArray<btSolverBody>& bodies;
};

/// The slip is kept in the contact points (contact_cache.h, columns 30 and 31), so a hand-off carries it.
class FrictionAnchors {
 public:
  /// Adds the pull of the anchors. Call when the solver's rows are made.
  void pull_back(const ContactRows& rows, const btContactSolverInfo& info);
  /// Measures how far contacts slid. Call when the rows are solved; they must still be those of pull_back().
  void measure(const ContactRows& rows, const btContactSolverInfo& info);
  /// Writes the slip into the contact points. Call when Bullet has written its results into them.
  void remember();

 private:
  /// Anchor of one contact: its slip `way`, and two directions across the normal that depend on the normal alone.
  struct Of {
    btManifoldPoint* point = nullptr;
    btVector3 first;
    btVector3 second;
    btVector3 way;
  };
  std::vector<Of> contacts_;  ///< by row of ContactRows::contacts
};

}  // namespace aurasim::physics
