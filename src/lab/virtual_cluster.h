// Nodes in virtual time over a network in memory: the protocol and the physics of a real run, with durations of frames
// and messages set by rules. It goes from event to event, so a trial takes only its computing time.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/region_map.h"
#include "core/scene.h"
#include "core/setpoint.h"
#include "lab/wire_post.h"
#include "node/node.h"
#include "node/timed.h"
#include "transport/memory_seams.h"
#include "transport/memory_transport.h"

namespace aurasim::lab {

/// Distance at which all regions are neighbours. Trials have at most four regions.
inline constexpr double kEverywhere_m = 1e9;

/// Bandwidth of a link that is never full, bytes per second.
inline constexpr double kUnlimited_B_s = std::numeric_limits<double>::infinity();

/// A link that passes no messages between two regions from `from_s` to `until_s`, in the run's simulated time.
struct BrokenLink {
  core::RegionId a{}, b{};
  double from_s = 0, until_s = 0;
};

struct ClusterRules {
  core::AuraRules aura;
  core::SyncMode sync = core::SyncMode::kBounded;
  bool coupled = false;       ///< regions are coupled (physics/coupling.h): all nodes compute a state at once
  physics::Settings physics;  ///< steps and substeps are taken from `aura` instead
  core::ControlRules control;
  double neighbour_distance_m = kEverywhere_m;
  bool hash_states = false;
  node::PhaseClock clock = node::PhaseClock::kWall;
  transport::Faults network;
  std::vector<BrokenLink> broken_links;
  /// If set, messages are coded as for DDS (lab/wire_post.h), and each node's link has this bandwidth, bytes per
  /// second. Otherwise they are handed over as they are.
  std::optional<double> bandwidth_B_s;
  double shortest_frame_s = 0;
  double longest_frame_s = 0;
  std::vector<double> phase_s;            ///< by region: delay of its steps after the shared epoch
  std::vector<core::Setpoints> recorded;  ///< effects of an earlier run, which this one repeats
  std::uint64_t seed = 1;
};

/// CPU time of this thread, seconds.
inline double thread_time_s() { return node::now_s(node::PhaseClock::kThreadCpu); }

/// Setup of a node, without region and generation.
node::NodeSetup node_setup(const ClusterRules& rules);

class VirtualCluster {
 public:
  /// `scene` must outlive the cluster. `world`: saved world that the run goes on from; null: state 0.
  VirtualCluster(const core::Scene& scene, const core::RegionMap& map, const ClusterRules& rules,
                 const core::WorldCut* world = nullptr, node::Recorded recorded = node::Recorded::kNo);
  ~VirtualCluster();

  /// Result of a step that a node has computed.
  struct Event {
    core::RegionId region{};
    const node::StepReport* report = nullptr;  ///< valid until the next event
  };
  /// Throws std::logic_error if every node waits for messages that nobody sends.
  Event next();
  /// The same; nothing if every node is in its last state, or waits for messages that nobody sends.
  std::optional<Event> try_next();
  /// From now on no node computes a state after `last`, or the node of this region does not.
  void end_in(core::Step last);
  void end_in(core::RegionId region, core::Step last) { member(region).last = last; }
  /// Pauses in `state`: all nodes compute this state and none the next, all messages under way arrive, and all nodes
  /// check the state (node::Node::stand). If it has to be computed again, that is done first. Throws std::logic_error
  /// if the nodes do not come to an end of it.
  void stand_in(core::Step state);
  /// Lets all messages under way arrive. No node computes a state.
  void deliver_all();
  /// The end of a region's process. The other nodes hear of it `lease_s` later.
  void crash(core::RegionId region, double lease_s);
  /// The end of a region's process in the middle of the next state, when it has posted so many parcels, or right after
  /// that state if it posts fewer. The others have this state if all parcels for it have come. For coupled regions.
  void crash_in_step(core::RegionId region, std::size_t parcels);
  /// Stops a node, which then computes no state. What it has sent still arrives.
  void stop(core::RegionId region) { member(region).is_alive = false; }
  bool is_alive(std::size_t region) const { return members_[region].is_alive; }
  double now_s() const { return network_.now_s(); }

  std::size_t size() const { return members_.size(); }
  bool is_coupled() const { return rules_.coupled; }
  const node::Node& node(std::size_t region) const { return *members_[region].node; }
  /// Mutable access, to give orders between two events. Region 0 is the lead.
  node::Node& node(std::size_t region) { return *members_[region].node; }
  /// Bodies of a region in its present state. Valid until its next step.
  std::span<const core::BodyRecord> records(std::size_t region) { return members_[region].node->world().records(); }
  /// Precondition: ClusterRules::bandwidth_B_s is set.
  const WirePost& post() const { return *post_; }
  /// Parcels between coupled regions so far.
  const transport::ParcelCount& parcels() const { return seams_.posted(); }
  /// The newest state that is confirmed on every live node (node/node.h).
  core::Step confirmed() const;
  /// The lowest state that a live node is in.
  core::Step slowest() const;
  /// Number of violations, all nodes together.
  std::uint64_t violations() const;
  std::uint64_t violations(core::ViolationKind kind) const;
  /// Time taken over time simulated, by the node furthest behind the clock: 1 is real time.
  double slow_down() const;

 private:
  struct Member {
    std::unique_ptr<node::Node> node;
    double phase_s = 0;
    double free_s = 0;     ///< end of its last frame
    double lag_s = 0;      ///< delay of its last frame's begin behind the clock
    bool waiting = false;  ///< its step is due, but messages of neighbours are missing
    bool is_alive = true;
    core::Step last = std::numeric_limits<core::Step>::max();  ///< it computes no later state
  };

  Member& member(core::RegionId region) { return members_[core::value_of(region)]; }

  bool holds(const Member& member) const;
  std::optional<Event> next_of_coupled();
  bool compute_all();
  std::string who_waits() const;
  bool all_stand();
  double due_s(const Member& member) const;
  void compute(Member& member, double at_s);
  double chance();

  ClusterRules rules_;
  core::RegionMap map_;
  transport::MemoryNetwork network_;
  std::optional<WirePost> post_;
  transport::MemorySeams seams_;
  std::deque<Event> computed_;  ///< by coupled nodes
  std::vector<Member> members_;
  bool stands_ = false;  ///< nodes in their last state check it, and compute on if it has to be computed again
  std::uint64_t random_;
  const node::StepReport* report_ = nullptr;
};

}  // namespace aurasim::lab
