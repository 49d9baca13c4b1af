// What holds bodies together on one node, for whoever draws it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

struct BodyPair {
  BodyId a{};
  BodyId b{};
};

/// The pairs of one node in state `stamp`.
struct ClusterGraph {
  RegionId source{};
  Generation generation = 0;
  Step stamp = 0;
  std::uint64_t map_version = 0;
  std::vector<BodyPair> links;     ///< that joined clusters: each cluster as a tree, as far as clusters were completed
  std::vector<BodyPair> contacts;  ///< that touch, or are within Bullet's contact margin
};

}  // namespace aurasim::core
