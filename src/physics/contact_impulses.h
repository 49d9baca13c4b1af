// What presses on what, summed up over a step, for observers: only while somebody wants to know. Looks on: no bit of
// what is computed hangs on it.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include <LinearMath/btVector3.h>

class btPersistentManifold;

namespace aurasim::physics {

/// Sums over the contact points of two objects.
struct ContactSum {
  double impulse = 0;         ///< N s
  btVector3 p{0, 0, 0};       ///< in Bullet's frame, times the impulse
  btVector3 normal{0, 0, 0};  ///< from the first to the second, likewise
};

class ContactImpulses {
 public:
  /// From the next step on.
  void want(bool wanted) { wanted_ = wanted; }
  bool wanted() const { return wanted_; }

  /// Before a step.
  void clear() { sums_.clear(); }
  /// User indices of the two, a point where they press, the normal from a to b, and how much.
  void add(int a, int b, const btVector3& p, const btVector3& normal, double impulse);
  /// After a solver's substep: what Bullet has left in the manifolds of those who are awake.
  void look(std::span<btPersistentManifold* const> manifolds);

  /// By the user indices of the two: the higher one first, for statics' are negative.
  const std::map<std::pair<int, int>, ContactSum>& sums() const { return sums_; }

 private:
  bool wanted_ = false;
  std::map<std::pair<int, int>, ContactSum> sums_;
};

}  // namespace aurasim::physics
