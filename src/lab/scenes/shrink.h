// Makes a failing world small, by leaving out everything that the failure does not need.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>

#include "lab/scenes/world_files.h"
#include "lab/scenes/world_trial.h"

namespace aurasim::lab {

struct Shrunk {
  World world;
  core::Step steps = 0;  ///< number of steps with which the run still fails
  WorldOutcome outcome;
  std::size_t trials = 0;
};

/// Delta debugging (Zeller, Hildebrandt, 2002): orders, injectors, joints, bodies and statics are left out, chunk by
/// chunk, as long as the world fails in the way in which it has failed at first; then everything else is made plain.
/// Ends after `budget_s` of the clock, or when `stop` becomes true, with the smallest world so far. `directory`: folder
/// for the worlds that it tries.
Shrunk shrink(const World& world, const WorldOutcome& failure, const TrialRules& rules, std::uint64_t seed,
              double budget_s, const std::filesystem::path& directory, const std::atomic<bool>& stop);

}  // namespace aurasim::lab
