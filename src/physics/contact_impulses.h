// Contact impulses between objects, summed over a step, for observers. Only computed while an observer wants them. No
// bit of the simulation depends on it.
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
  btVector3 p{0, 0, 0};       ///< sum of contact points times their impulses, in Bullet's frame
  btVector3 normal{0, 0, 0};  ///< sum of normals, from the first object to the second, times their impulses
};

class ContactImpulses {
 public:
  /// Switches the sums on or off, from the next step on.
  void want(bool wanted) { wanted_ = wanted; }
  bool wanted() const { return wanted_; }

  /// Call before each step.
  void clear() { sums_.clear(); }
  /// Adds an impulse (N s) between the objects with user indices `a` and `b`, at point `p`. `normal` points from a to
  /// b.
  void add(int a, int b, const btVector3& p, const btVector3& normal, double impulse);
  /// Call after each substep of Bullet's solver: adds the impulses that it left in the manifolds of awake bodies.
  void look(std::span<btPersistentManifold* const> manifolds);

  /// Sums by the user indices of the two objects, the higher one first. Indices of statics are negative.
  const std::map<std::pair<int, int>, ContactSum>& sums() const { return sums_; }

 private:
  bool wanted_ = false;
  std::map<std::pair<int, int>, ContactSum> sums_;
};

}  // namespace aurasim::physics
