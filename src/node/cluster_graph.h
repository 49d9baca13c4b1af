// The cluster graph of a node: which of its bodies form clusters, and the links between them.
#pragma once

#include "core/cluster_graph.h"
#include "node/node.h"

namespace aurasim::node {

/// The cluster graph of the last state. Its links are those that the protocol saw before bodies were handed over.
core::ClusterGraph cluster_graph_of(Node& node, core::Generation generation, std::uint64_t map_version);

}  // namespace aurasim::node
