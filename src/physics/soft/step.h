// The soft step: what touches is found once a step, and solved in substeps. In each, contacts push apart what overlaps
// as springs do; then bodies move; then contacts are rigid and rub, so that nothing keeps the speed of a push, and what
// is to bounce does so at the end (E. Catto, "Solver2D", 2024). Contacts are coloured and computed side by side
// (soft/patches.h), joints one after the other (soft/joints.h). Bodies that touch nothing fly on their parabola.
#pragma once

#include <memory>
#include <span>

class btRigidBody;
class btTypedConstraint;
class btVector3;

namespace aurasim::physics {

class ContactImpulses;
class SoftContacts;
struct SoftTouch;

class SoftStep {
 public:
  SoftStep(double step_s, int substeps, int threads);
  ~SoftStep();

  /// Moves and turns `bodies`: all that are awake. `moving_statics` push them, and are where they were afterwards. Each
  /// island's touches and joints come in an order that follows from the island alone; all awake touches have their
  /// patches in `contacts`. Gravity in m/s^2. Tells `impulses` what has pressed on what, if it wants to know.
  void solve(std::span<btRigidBody* const> bodies, std::span<btRigidBody* const> moving_statics,
             std::span<const SoftTouch> touches, SoftContacts& contacts, std::span<btTypedConstraint* const> joints,
             const btVector3& gravity, ContactImpulses& impulses);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
