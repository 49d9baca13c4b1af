// A run that is never left in peace, in virtual time, for hours: bodies are kicked, come and go, nodes die, the world
// is saved and goes on from the file on other nodes. Beside it the same world on one node, to which nothing happens.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "config/launch.h"
#include "lab/launch_rules.h"

namespace aurasim::lab {

struct EndurancePlan {
  double hours = 24;  ///< simulated
  std::uint64_t seed = 1;
  double told_every_h = 1;  ///< simulated
  SetupOf setup_of;
};

/// What has come of it so far.
struct Endured {
  core::Step state = 0;
  double hours = 0;
  std::uint64_t deaths = 0, loads = 0, orders = 0;
  std::uint64_t compared = 0;     ///< states
  std::uint64_t computed = 0;     ///< by the nodes, all together, those after a death once more
  std::uint64_t bodies = 0;       ///< in the last state that was gone on from, those announced among them
  std::uint64_t resident_kB = 0;  ///< memory of this process
  std::string failure;            ///< empty: none
};

/// Until the first failure, or the end, or `stop` becomes true. `tell` hears of the beginning, each so many hours, and
/// the end.
Endured endure(const config::Launch& launch, const EndurancePlan& plan, const std::function<void(const Endured&)>& tell,
               const std::atomic<bool>& stop);

}  // namespace aurasim::lab
