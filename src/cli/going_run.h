// For a node that is started again by somebody who does not know whether the run goes on without it.
#pragma once

#include <map>
#include <string>

#include "config/launch.h"
#include "core/ids.h"
#include "dds/control_messages.h"

namespace aurasim::cli {

/// Does any region's node compute, or stand because of somebody who has died? Those that wait for each other to begin,
/// and those that have ended, are no run that goes on.
bool goes_on(const std::map<core::RegionId, dds::SeenStatus>& statuses);

/// Joins as `top` does, for some seconds where nobody is heard. Its DDS participant stays: who calls this becomes
/// another program soon (cli/leave.h says why nobody says goodbye).
bool a_run_goes_on(const config::Launch& launch, const std::string& as, core::RegionId region);

}  // namespace aurasim::cli
