// A run in which nodes die, in virtual time: each time all go back to the newest state of which everybody's part is
// kept, and that everybody has recorded, and compute on from there on the same map. Parts are kept elsewhere: what a
// node has had in memory dies with it.
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
  core::Step steps = 0;  ///< of the run; a death comes anywhere in them
  std::uint64_t seed = 1;
};

/// Nothing when `stop` became true. `cluster` is the last one that has run.
std::optional<Played> play_with_deaths(const Disasters& disasters, const config::Launch& launch,
                                       const ClusterRules& rules, Interference& interference,
                                       const std::atomic<bool>& stop, std::optional<VirtualCluster>& cluster);

}  // namespace aurasim::lab
