// Nodes in virtual time over a network in memory: the protocol and the physics of a real run, with frames and
// messages as long as they are told to be. Goes from event to event, so a trial takes as long as its arithmetic.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/region_map.h"
#include "core/scene.h"
#include "core/setpoint.h"
#include "lab/wire_post.h"
#include "node/node.h"
#include "transport/memory_transport.h"

namespace aurasim::lab {

/// All regions of a trial listen to each other: there are at most four.
inline constexpr double kEverywhere_m = 1e9;

/// Nothing passes between two regions from one time to another, counted as the run's states are.
struct BrokenLink {
  core::RegionId a{}, b{};
  double from_s = 0, until_s = 0;
};

struct ClusterRules {
  core::AuraRules aura;
  core::SyncMode sync = core::SyncMode::kBounded;
  physics::Settings physics;  ///< but for steps and substeps, which are the aura's
  core::ControlRules control;
  double neighbour_distance_m = kEverywhere_m;
  bool hash_states = false;
  node::PhaseClock clock = node::PhaseClock::kWall;
  transport::Faults network;
  std::vector<BrokenLink> broken_links;
  /// Messages are coded as for DDS (lab/wire_post.h), and each node's link takes so many bytes a second.
  std::optional<double> bandwidth_B_s;
  double shortest_frame_s = 0;
  double longest_frame_s = 0;
  std::vector<double> phase_s;         ///< by region: how much later than the shared epoch its steps are due
  core::Step shuffle_ranks_steps = 0;  ///< who outranks whom changes about so often; 0: as in a real run
  std::uint64_t seed = 1;
};

/// But for the region and the generation.
node::NodeSetup node_setup(const ClusterRules& rules);

class VirtualCluster {
 public:
  /// The scene outlives the cluster. `world`: saved; the run goes on from it.
  VirtualCluster(const core::Scene& scene, const core::RegionMap& map, const ClusterRules& rules,
                 const core::WorldCut* world = nullptr, node::Recorded recorded = node::Recorded::kNo);
  ~VirtualCluster();

  /// Goes on to the next step that a node computes, and says which and what it did.
  struct Event {
    core::RegionId region{};
    const node::StepReport* report = nullptr;  ///< valid until the next event
  };
  Event next();
  /// As in a pause: all nodes compute this state and none the next, and what they have sent arrives.
  void stand_in(core::Step state);

  std::size_t size() const { return members_.size(); }
  const node::Node& node(std::size_t region) const { return *members_[region].node; }
  /// To give it orders between two events; region 0 is the lead.
  node::Node& node(std::size_t region) { return *members_[region].node; }
  /// Bodies of a region in the state that it is in. Valid until its next step.
  std::span<const core::BodyRecord> records(std::size_t region) { return members_[region].node->world().records(); }
  /// Only where messages are coded.
  const WirePost& post() const { return *post_; }
  /// The newest state that every node takes for confirmed (node/node.h).
  core::Step confirmed() const;
  /// The lowest state that a node is in.
  core::Step slowest() const;
  /// Broken promises, all nodes together.
  std::uint64_t violations() const;
  std::uint64_t violations(core::ViolationKind kind) const;
  /// Time taken over time simulated, by the node furthest behind the clock: 1 is real time.
  double slow_down() const;

 private:
  struct Member {
    std::unique_ptr<node::Node> node;
    double phase_s = 0;
    double free_s = 0;     ///< end of its last frame
    double lag_s = 0;      ///< of its last frame's begin behind the clock
    bool waiting = false;  ///< due, but for its neighbours' messages
  };

  double due_s(const Member& member) const;
  void compute(Member& member, double at_s);
  double chance();

  ClusterRules rules_;
  core::RegionMap map_;
  transport::MemoryNetwork network_;
  std::optional<WirePost> post_;
  std::vector<Member> members_;
  std::uint64_t random_;
  const node::StepReport* report_ = nullptr;
  core::Step last_ = std::numeric_limits<core::Step>::max();  ///< no node goes beyond it
};

}  // namespace aurasim::lab
