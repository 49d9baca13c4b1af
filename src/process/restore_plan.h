// Chooses the state that all nodes go back to when a node has died, from the nodes' statuses. Uses no clock and no DDS.
#pragma once

#include <map>
#include <optional>

#include "messages/control_messages.h"

namespace aurasim::process {

struct RestorePlan {
  core::RegionId lead{};           ///< region whose node sends the command to the others
  messages::RunCommand command{};  ///< kRestore, without the times
};

/// The plan, or nothing as long as a region has no node, a node still computes, or a node does not receive from all
/// others. The state is the newest of which all parts are kept, or the first one of the scene (then RunCommand::count
/// is 1).
std::optional<RestorePlan> plan_restore(const std::map<core::RegionId, messages::SeenStatus>& nodes,
                                        std::size_t regions);

}  // namespace aurasim::process
