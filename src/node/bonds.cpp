#include "node/bonds.h"

namespace aurasim::node {

core::Bonds bonds_of(Node& node, core::Generation generation, std::uint64_t map_version) {
  core::Bonds bonds;
  bonds.source = node.region();
  bonds.generation = generation;
  bonds.map_version = map_version;
  const core::Gathering& gathering = node.protocol().gathering();
  for (const core::Contact& link : gathering.clusters().links()) {
    bonds.links.push_back({gathering.id(link.a), gathering.id(link.b)});
  }
  const core::Snapshot& snapshot = node.world().snapshot();
  bonds.stamp = snapshot.step;
  for (const core::Contact& contact : snapshot.contacts) {
    bonds.contacts.push_back({snapshot.bodies[contact.a].id, snapshot.bodies[contact.b].id});
  }
  return bonds;
}

}  // namespace aurasim::node
