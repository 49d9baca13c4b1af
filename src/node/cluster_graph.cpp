#include "node/cluster_graph.h"

namespace aurasim::node {

core::ClusterGraph cluster_graph_of(Node& node, core::Generation generation, std::uint64_t map_version) {
  core::ClusterGraph graph;
  graph.source = node.region();
  graph.generation = generation;
  graph.map_version = map_version;
  const core::InterestMatching& matching = node.protocol().matching();
  for (const core::Contact& link : matching.clusters().links()) {
    graph.links.push_back({matching.id(link.a), matching.id(link.b)});
  }
  const core::Snapshot& snapshot = node.world().snapshot();
  graph.stamp = snapshot.step;
  for (const core::Contact& contact : snapshot.contacts) {
    graph.contacts.push_back({snapshot.bodies[contact.a].id, snapshot.bodies[contact.b].id});
  }
  return graph;
}

}  // namespace aurasim::node
