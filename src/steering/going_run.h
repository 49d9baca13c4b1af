// Finds out whether a run goes on, for a node that is started again without that knowledge.
#pragma once

#include <map>
#include <string>

#include "config/launch.h"
#include "core/ids.h"
#include "messages/control_messages.h"

namespace aurasim::steering {

/// True if any region's node computes, or waits because another node has died. Nodes that wait for each other to begin,
/// and nodes that have ended, do not count.
bool goes_on(const std::map<core::RegionId, messages::SeenStatus>& statuses);

/// Joins the domain as `top` does and looks for a run; waits some seconds if no status comes. The DDS participant is
/// not deleted, because the caller becomes another program soon (the reason is in command_line/leave.h).
bool a_run_goes_on(const config::Launch& launch, const std::string& as, core::RegionId region);

}  // namespace aurasim::steering
