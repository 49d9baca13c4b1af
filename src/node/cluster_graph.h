// Which bodies of a node hang together, and by what.
#pragma once

#include "core/cluster_graph.h"
#include "node/node.h"

namespace aurasim::node {

/// In the last state. The links are those that the protocol saw, before bodies were handed over.
core::ClusterGraph cluster_graph_of(Node& node, core::Generation generation, std::uint64_t map_version);

}  // namespace aurasim::node
