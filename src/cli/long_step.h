// A node that computes one step for long says nothing meanwhile, but its process shows life: it is slow, not dead.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "dds/control_messages.h"

namespace aurasim::cli {

/// "computes one step for 12 s". Nothing: its last status is not old, or it is not there, or does not compute.
std::optional<std::string> long_step(const dds::SeenStatus& seen, std::chrono::steady_clock::time_point now);

/// Which long steps a log is told of: each once after 10 s, and again each time that it has taken twice as long.
class LongSteps {
 public:
  using Clock = std::chrono::steady_clock;

  /// A line for the log, if there is news of this node.
  std::optional<std::string> news(const dds::SeenStatus& seen, Clock::time_point now);

 private:
  std::map<core::RegionId, Clock::duration> told_;  ///< of steps that are not yet over
};

}  // namespace aurasim::cli
