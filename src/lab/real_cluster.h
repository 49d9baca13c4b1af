// A few nodes over DDS in real time, each with a thread and a participant of its own, that stay up from run to run.
// Frames last as long as they are told to, and a step's messages leave at the end of its frame; the network is delayed
// and loses datagrams by the transport's impairment (dds/impairment.h). Traffic stays on loopback.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/region_map.h"
#include "core/scene.h"
#include "lab/virtual_cluster.h"
#include "node/node.h"

namespace aurasim::lab {

struct RealNetwork {
  std::uint32_t domain = 0;
  std::filesystem::path profiles;
  double latency_s = 0;  ///< one way, beyond what the machine takes by itself
  double loss = 0;       ///< probability that a datagram is lost
  std::uint64_t seed = 1;
};

/// What one node did in a run.
struct Course {
  /// Broken promises up to the end of a step; those of latency are known before it is computed.
  struct Promises {
    std::uint64_t broken = 0;
    std::uint64_t latency = 0;
  };
  std::vector<node::SeenCollision> contacts;
  std::vector<node::HandOffRow> departures;
  std::vector<Promises> promises;  ///< by step, from 0
  double slow_down = 1;            ///< time taken over time simulated
};

/// Used by one thread.
class RealCluster {
 public:
  /// Returns when all nodes have found each other. Throws dds::DdsError.
  RealCluster(const core::RegionMap& map, const RealNetwork& network);
  ~RealCluster();

  /// One world from state 0 to state `last`, by region. Of `rules.network` nothing is used. Throws std::runtime_error
  /// when a node does not get on.
  std::vector<Course> run(const core::Scene& scene, const ClusterRules& rules, core::Step last);

 private:
  struct Member;

  core::RegionMap map_;
  std::vector<std::unique_ptr<Member>> members_;
  core::Generation generation_ = 0;
};

}  // namespace aurasim::lab
