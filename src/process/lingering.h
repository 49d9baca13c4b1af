// Decides how long a node stays after its last state. The others may still need its last messages, and this node their
// acknowledgements. In a free-running run one node may come to the last state long before the rest; if it left, they
// would take it for dead. Uses no DDS: time is passed in.
#pragma once

#include <chrono>
#include <map>
#include <vector>

#include "process/recovery.h"

namespace aurasim::process {

/// True if all other nodes have left or died. `silent`: neighbours marked dead. The last status of a node that has
/// ended may be lost, so silence counts as well.
bool all_have_left(const SeenNodes& nodes, core::RegionId self, const std::vector<core::RegionId>& silent);

class Lingering {
 public:
  using Clock = std::chrono::steady_clock;

  /// The node of region `self` has computed its last state.
  Lingering(core::RegionId self, Clock::time_point now) : self_(self), begin_(now), moved_(now) {}

  /// True if the node has to stay longer. A node that others may need stays for a moment, and as long as some other
  /// node makes progress. `is_complete`: nobody needs anything of this node any more. `is_stopped`: the process was
  /// asked to stop.
  bool stays(const SeenNodes& nodes, bool is_complete, bool is_stopped, Clock::time_point now);

 private:
  bool others_run(const SeenNodes& nodes, Clock::time_point now);

  core::RegionId self_;
  Clock::time_point begin_;
  Clock::time_point moved_;                     ///< when any node was last seen to go on
  std::map<core::RegionId, core::Step> steps_;  ///< state of each node at that look
};

}  // namespace aurasim::process
