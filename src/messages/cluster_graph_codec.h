// Encodes core/cluster_graph.h as a wire type, and decodes it. Same contract as codec.h.
#pragma once

#include "core/cluster_graph.h"
#include "messages/codec.h"

namespace aurasim::wire {
class ClusterGraph;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const core::ClusterGraph& graph, wire::ClusterGraph& out);
Decoded<core::ClusterGraph> decode(const wire::ClusterGraph& in, const Expected& expected);

}  // namespace aurasim::messages
