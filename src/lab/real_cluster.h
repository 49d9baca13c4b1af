// A few nodes over DDS in real time, each with a thread and a participant of its own, that stay up from run to run.
// Frames last as long as the rules say, and a step's messages leave at the end of its frame. Delay and loss of the
// network come from the transport's impairment (dds/impairment.h). Traffic stays on loopback.
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
  double latency_s = 0;  ///< one-way latency added to the machine's own
  double loss = 0;       ///< probability that a datagram is lost
  std::uint64_t seed = 1;
};

/// What one node did in a run.
struct Course {
  /// Numbers of broken promises up to the end of a step. Those of latency are known before the step is computed.
  struct Promises {
    std::uint64_t broken = 0;
    std::uint64_t latency = 0;
  };
  std::vector<node::SeenCollision> contacts;
  std::vector<node::HandOffRow> departures;
  std::vector<Promises> promises;  ///< by step, from 0
  double slow_down = 1;            ///< time taken over time simulated
};

/// May be used by one thread only.
class RealCluster {
 public:
  /// Returns when all nodes have found each other. Throws dds::DdsError.
  RealCluster(const core::RegionMap& map, const RealNetwork& network);
  ~RealCluster();

  /// Runs one world from state 0 to state `last`. Returns the courses by region. `rules.network` is ignored. Throws
  /// std::runtime_error when a node makes no progress.
  std::vector<Course> run(const core::Scene& scene, const ClusterRules& rules, core::Step last);

 private:
  struct Member;

  core::RegionMap map_;
  std::vector<std::unique_ptr<Member>> members_;
  core::Generation generation_ = 0;
};

}  // namespace aurasim::lab
