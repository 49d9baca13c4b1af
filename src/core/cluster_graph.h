// Why bodies of one node belong together: published for viewers, which draw it.
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
  std::vector<BodyPair> links;     ///< pairs that joined clusters: a tree of each cluster that was completed
  std::vector<BodyPair> contacts;  ///< pairs that touch, or are within Bullet's contact margin
};

}  // namespace aurasim::core
