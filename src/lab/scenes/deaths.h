// A run in which nodes die, in virtual time. After each death all nodes go back to the newest state of which all parts
// are kept and that all have recorded, and compute on from there on the same map. Parts are kept outside the node,
// because its memory dies with it.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "config/launch.h"
#include "lab/scenes/play.h"

namespace aurasim::lab {

struct Disasters {
  int deaths = 1;
  core::Step steps = 0;  ///< steps of the run; deaths come at random steps
  std::uint64_t seed = 1;
};

/// Plays the run. Nothing when `stop` became true. `cluster` is set to the cluster that ran last.
std::optional<Played> play_with_deaths(const Disasters& disasters, const config::Launch& launch,
                                       const ClusterRules& rules, Interference& interference,
                                       const std::atomic<bool>& stop, std::optional<VirtualCluster>& cluster);

}  // namespace aurasim::lab
