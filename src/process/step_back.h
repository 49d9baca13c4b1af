// Chooses the earlier state that a run goes back to on request, from the parts that the nodes' statuses list. Uses no
// clock and no DDS.
#pragma once

#include <map>
#include <optional>

#include "messages/control_messages.h"

namespace aurasim::process {

/// The command (kRestore), without the times, that takes all nodes back to the newest state not later than `latest` of
/// which every region's node keeps its own part. Orders given since are dropped. Nothing if there is no such state, or
/// if a node is missing or in another phase.
std::optional<messages::RunCommand> plan_step_back(const std::map<core::RegionId, messages::SeenStatus>& nodes,
                                                   std::size_t regions, core::Step latest);

}  // namespace aurasim::process
