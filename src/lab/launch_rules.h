// A launch file's rules for nodes in virtual time.
#pragma once

#include <functional>

#include "config/launch.h"
#include "lab/virtual_cluster.h"
#include "node/node.h"

namespace aurasim::lab {

/// A launch's rules for one of its nodes.
using SetupOf = std::function<node::NodeSetup(const config::Launch&, core::RegionId)>;

/// What nodes of this launch are told, who listens to whom included. Clock, network and frames are left to the caller.
ClusterRules launch_rules(const config::Launch& launch, const SetupOf& setup_of);

}  // namespace aurasim::lab
