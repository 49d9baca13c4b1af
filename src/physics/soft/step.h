// The soft step: contacts are found once a step and solved in substeps. In each substep, contacts first push overlaps
// apart like springs. Then bodies move. Then contacts are rigid and have friction, so that no body keeps the speed of a
// push. Restitution is applied at the end (E. Catto, "Solver2D", 2024). Contacts are coloured and computed side by side
// (soft/patches.h), joints one after the other (soft/joints.h). Bodies that touch nothing move on their parabola.
#pragma once

#include <memory>
#include <span>

class btRigidBody;
class btTypedConstraint;
class btVector3;

namespace aurasim::physics {

class ContactImpulses;
namespace soft {
class Team;
}
class SoftContacts;
class SoftShared;
struct Settings;
struct SoftTouch;

class SoftStep {
 public:
  SoftStep(const Settings& settings, soft::Team& team);
  ~SoftStep();

  /// Moves and turns `bodies`: all that are awake. `moving_statics` push them, and their own poses are not changed. The
  /// touches and joints of each island have to come in an order that follows from the island alone; `contacts` has the
  /// patches of all touches. Gravity in m/s^2. Adds the contact impulses to `impulses`, if wanted. `shared` has the
  /// contacts with bodies of other regions; null if there are none.
  void solve(std::span<btRigidBody* const> bodies, std::span<btRigidBody* const> moving_statics,
             std::span<const SoftTouch> touches, SoftContacts& contacts, std::span<btTypedConstraint* const> joints,
             const btVector3& gravity, ContactImpulses& impulses, SoftShared* shared);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
