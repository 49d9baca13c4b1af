// Settings of the simulation. They have to be the same on all nodes of a run.
#pragma once

#include "core/block.h"
#include "core/body_state.h"
#include "core/limits.h"

namespace aurasim::physics {

enum class Solver {
  kSequentialImpulse,  ///< projected Gauss-Seidel
  kSoftStep,           ///< contacts are looked for once a step and solved as soft contacts in substeps (soft/step.h)
};

/// The defaults are those of Bullet's own step. Launch files without a solver get the soft step (config/presets.h).
struct Settings {
  double step_s = 1.0 / 60;
  int substeps = 4;
  /// Are contacts looked for once a step instead of once a substep?
  bool looks_once() const { return solver == Solver::kSoftStep; }
  int looks() const { return looks_once() ? 1 : substeps; }
  Solver solver = Solver::kSequentialImpulse;
  int solver_iterations = 10;
  /// Side of the blocks (core/block.h), m.
  double block_m = core::kUsualBlock_m;
  /// Number of threads of the soft step. It changes no bit.
  int threads = 1;
  /// Share of an overlap that contacts undo in a substep; the speed of that push stays (Bullet's error reduction
  /// parameter).
  double contact_erp = 0.2;
  /// Rows of friction at each contact point. 1: along the sliding velocity, as in Bullet. 2: two perpendicular
  /// directions. With 1, the direction is off the load where nothing slides yet, so piles creep and a card house falls.
  int friction_directions = 1;
  /// Continuous collision detection: a body that moves farther in a substep than it is thick stops at the first
  /// obstacle. It loses the rest of the substep, not its speed.
  bool continuous = false;
  /// Other nodes act upon an aura for so long. During that time a force may take the body off its path.
  double foresight_s = 0.2;
  /// Impulses and velocities of clients that would make a body faster than this are not executed.
  double top_speed_m_s = core::limits::kFastestBody_m_s;
};

}  // namespace aurasim::physics
