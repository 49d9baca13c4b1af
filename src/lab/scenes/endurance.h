// A run of hours with constant disturbances, in virtual time: bodies get impulses, come and go, nodes die, and the
// world is saved and goes on from the file on other nodes. It is compared with the same world on one undisturbed node.
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

/// Results of the run so far.
struct Endured {
  core::Step state = 0;
  double hours = 0;
  std::uint64_t deaths = 0, loads = 0, orders = 0;
  std::uint64_t compared = 0;     ///< number of states compared
  std::uint64_t computed = 0;     ///< states computed by all nodes, repeated ones included
  std::uint64_t bodies = 0;       ///< bodies in the last saved state that the run went on from, announced ones included
  std::uint64_t resident_kB = 0;  ///< memory of this process
  std::string failure;            ///< empty: none
};

/// Runs until the first failure, the end, or `stop` becomes true. `tell` is called at the beginning, every
/// `told_every_h` simulated hours, and at the end.
Endured endure(const config::Launch& launch, const EndurancePlan& plan, const std::function<void(const Endured&)>& tell,
               const std::atomic<bool>& stop);

}  // namespace aurasim::lab
