// How a world is simulated: the same on all nodes of a run.
#pragma once

#include "core/body_state.h"
#include "core/limits.h"

namespace aurasim::physics {

enum class Solver {
  kSequentialImpulse,  ///< projected Gauss-Seidel
  kSoftStep,           ///< what touches is found once a step; soft contacts in substeps (soft/step.h)
};

/// By themselves those of Bullet's own step; launch files ask for the soft step if they do not say (config/presets.h).
struct Settings {
  double step_s = 1.0 / 60;
  int substeps = 4;
  /// For what touches, in a step.
  bool looks_once() const { return solver == Solver::kSoftStep; }
  int looks() const { return looks_once() ? 1 : substeps; }
  Solver solver = Solver::kSequentialImpulse;
  int solver_iterations = 10;
  /// Of the soft step. Their number changes no bit.
  int threads = 1;
  /// Share of an overlap that contacts undo in a substep, by a speed that stays (Bullet's error reduction parameter).
  double contact_erp = 0.2;
  /// Rows of friction at each contact point: 1 along the sliding velocity, 2 across each other. Bullet's own 1 turns
  /// away from the load where nothing slides yet: piles creep, and a card house falls.
  int friction_directions = 1;
  /// Continuous collision detection: a body that moves farther in a substep than it is thick stops at what is in its
  /// way. It loses the rest of the substep, not its speed.
  bool continuous = false;
  /// So far ahead others act upon what they are told of a body: for that long a force may take it off its path.
  double foresight_s = 0.2;
  /// An impulse or a velocity of a client that would make a body faster is not obeyed.
  double top_speed_m_s = core::limits::kFastestBody_m_s;
};

}  // namespace aurasim::physics
