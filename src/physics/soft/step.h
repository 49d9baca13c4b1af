// The soft step: contacts are found once a step and solved in substeps. In each substep, contacts first push overlaps
// apart like springs. Then bodies move. Then contacts are rigid and have friction, so that no body keeps the speed of a
// push. Restitution is applied at the end (E. Catto, "Solver2D", 2024). Contacts are coloured and computed side by side
// (soft/patches.h), joints one after the other (soft/joints.h). Bodies that touch nothing move on their parabola.
#pragma once

#include <memory>

#include "physics/soft/movers.h"

namespace aurasim::physics {

class ContactImpulses;
class SoftContacts;

class SoftStep {
 public:
  SoftStep(const Settings& settings, soft::Team& team);
  ~SoftStep();

  /// Moves and turns all bodies that are awake. The touches and joints of each island have to come in an order that
  /// follows from the island alone; `contacts` has the patches of all touches. Adds the contact impulses to `impulses`,
  /// if wanted.
  void solve(const SoftBodies& bodies, SoftContacts& contacts, ContactImpulses& impulses);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
