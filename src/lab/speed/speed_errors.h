// Errors of the states that a run has written, by the same measures for all engines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab/speed/states.h"

namespace aurasim::lab {

struct SpeedErrors {
  double overlap_m = 0;    ///< deepest that two bodies are in each other, in any of the states
  double in_static_m = 0;  ///< deepest that a body is in the ground, a step or a wall, in any of the states
  double drift_m = 0;      ///< farthest that a body is from where it was at first, in the last state
  double sunk_m = 0;       ///< deepest that a body is below where it was at first, in the last state
  double fallen = 0;       ///< bodies that are lower by more than SpeedScene::fallen_m, in the last state
  double lost = 0;    ///< bodies that are missing, nowhere, or wholly inside of what does not move, in the last state
  double energy = 0;  ///< (E - E0) / E0, in the last state; E0 of the bodies as they were at first
  double joint_gap_m = 0;     ///< farthest that the two ends of a joint are apart, in any of the states
  double hinge_turn_rad = 0;  ///< farthest that a hinge is bent off its axis or over its limits, in any of the states
};

SpeedErrors errors_of(const SpeedScene& scene, const std::vector<SeenState>& states);

/// The errors of one run.
struct StateErrors {
  std::string scene, engine, precision, threads;
  SpeedErrors errors;
};

/// The errors of all files of DIR/states, which are named SCENE.ENGINE.PRECISION.THREADS.txt.
std::vector<StateErrors> errors_of_states(const std::filesystem::path& directory);

}  // namespace aurasim::lab
