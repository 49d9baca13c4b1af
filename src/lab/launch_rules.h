// Makes rules for nodes in virtual time from a launch file.
#pragma once

#include <functional>

#include "config/launch.h"
#include "lab/virtual_cluster.h"
#include "node/node.h"

namespace aurasim::lab {

/// Returns the setup of one node of a launch.
using SetupOf = std::function<node::NodeSetup(const config::Launch&, core::RegionId)>;

/// Rules for the nodes of this launch, with the distance of neighbours. The caller sets clock, network and frames.
ClusterRules launch_rules(const config::Launch& launch, const SetupOf& setup_of);

}  // namespace aurasim::lab
