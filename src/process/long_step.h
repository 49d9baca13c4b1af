// Detects a node that computes one step for long. It publishes no status meanwhile, but its process shows life: it is
// slow, not dead.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "messages/control_messages.h"

namespace aurasim::process {

/// A text such as "computes one step for 12 s". Nothing if the node's last status is recent, or if the node is not
/// alive or does not compute.
std::optional<std::string> long_step(const messages::SeenStatus& seen, std::chrono::steady_clock::time_point now);

/// True if a node of another region than `self` computes one step for long. It is not dead, so a wait for all nodes
/// goes on.
bool computes_for_long(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::RegionId self,
                       std::chrono::steady_clock::time_point now);

/// Chooses the long steps to log: each once after 10 s, and again each time that its duration has doubled.
class LongSteps {
 public:
  using Clock = std::chrono::steady_clock;

  /// A line for the log, if there is news of this node.
  std::optional<std::string> news(const messages::SeenStatus& seen, Clock::time_point now);

 private:
  std::map<core::RegionId, Clock::duration> logged_;  ///< duration last logged, of steps that are not over yet
};

}  // namespace aurasim::process
