// The lead's knowledge of the run while it serves clients, from the statuses that nodes publish.
#pragma once

#include "process/command_server.h"
#include "process/recovery.h"

namespace aurasim::process {

/// The view of the node with status `own`. `nodes` must outlive the view. The lead is the live node of the lowest
/// region. Nodes of runs that do not agree with this one do not count.
RunView view_of_run(const SeenNodes& nodes, const messages::Status& own, std::optional<core::Step> holds_at);

}  // namespace aurasim::process
