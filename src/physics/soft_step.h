// The soft step: what touches is found once a step, and solved in substeps. In each, contacts push apart what overlaps
// as springs do; then bodies move; then contacts are rigid and rub, so that nothing keeps the speed of a push, and what
// is to bounce does so at the end (E. Catto, "Solver2D", 2024). Contacts are coloured and computed side by side
// (soft_patches.h), joints one after the other (soft_joints.h). Bodies that touch nothing fly on their parabola.
#pragma once

#include <memory>
#include <span>

class btCollisionObject;
class btPersistentManifold;
class btTypedConstraint;

namespace aurasim::physics {

class SoftStep {
 public:
  SoftStep(double step_s, int substeps);
  ~SoftStep();

  /// An island that is awake. Manifolds and joints in an order that follows from the island alone.
  void add(std::span<btCollisionObject* const> bodies, std::span<btPersistentManifold* const> manifolds,
           std::span<btTypedConstraint* const> joints);
  /// Moves and turns all bodies that have been added, and forgets them.
  void solve();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
