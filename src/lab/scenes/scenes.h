// Runs many random worlds: each seed's world on its regions and on one node, and compares them.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "lab/on_threads.h"
#include "lab/scenes/world_trial.h"

namespace aurasim::lab {

struct ScenesPlan {
  std::uint64_t first = 1, last = 200;  ///< seeds
  TrialRules rules;
  double shrink_s = 60;  ///< time to shrink each failing seed's world, seconds; 0: not shrunk
  bool keep = false;     ///< keep the files of seeds that do not fail, too
};

/// Runs the seeds that DIR/seeds.csv lacks, on `threads` threads, and appends a row as each ends. The worlds of those
/// that fail stay in DIR/seed_N, shrunk in DIR/seed_N/shrunk; all do with `keep`. Throws std::runtime_error when DIR
/// holds seeds that were run by other rules. Returns false if `progress` or `stop`, which also ends the seeds at work,
/// ended it early.
bool run_scenes(const ScenesPlan& plan, const std::filesystem::path& directory, int threads, const Progress& progress,
                const std::atomic<bool>& stop);

/// Sums over the plan's seeds that have been run; also written to DIR/summary.json. `failed_seeds` lists those that
/// failed.
nlohmann::json summarise_scenes(const ScenesPlan& plan, const std::filesystem::path& directory);

}  // namespace aurasim::lab
