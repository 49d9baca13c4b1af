// A run of a whole cluster of nodes in virtual time (lab/virtual_cluster.h), with the invariants of docs/design.md,
// "Exactly once", checked on every step.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "lab/scenes/play.h"
#include "lab/virtual_cluster.h"

namespace aurasim::test {

/// The end of a region's process. Others go on without it here, for tests of who watches a run; the nodes of a real run
/// stand then.
struct Crash {
  core::RegionId region{};
  core::Step step = 0;  ///< after computing this state
  double lease_s = 0.2;
};

/// One region's link to all others; what is sent meanwhile comes afterwards.
struct LinkCut {
  core::RegionId region{};
  double from_s = 0;
  double until_s = 0;
};

/// Frames of every node take from 4 ms on.
struct ClusterOptions : lab::ClusterRules {
  ClusterOptions() {
    hash_states = true;
    shortest_frame_s = longest_frame_s = 0.004;
  }
  void set_frame_jitter(double jitter_s) { longest_frame_s = shortest_frame_s + jitter_s; }

  core::RegionMap map = core::RegionMap::columns(1, 1);
  std::optional<Crash> crash;
  std::optional<LinkCut> cut;
  core::Step overrun = 0;  ///< region 0 ends in the last state; the others go so many on, if they need not wait for it
  std::vector<std::pair<core::Step, core::Action>> orders;  ///< given to region 0 in state 0, by the state they name
};

/// Options of a deterministic run that checks every state, over a coded network whose faults follow from the seed.
ClusterOptions checked_options(int seed);

struct Outcome : lab::Played {
  std::uint64_t late = 0;
  std::uint64_t missed = 0;
  std::uint64_t unflagged = 0;  ///< late or missed, without a violation before
  std::uint64_t violations = 0;
  std::uint64_t late_words = 0;  ///< of those: heard too late, and computed again over
  std::uint64_t thrashed = 0;
  std::uint64_t doubled = 0;  ///< bodies ever seen on two live nodes at once
  std::uint64_t lost = 0;
  std::uint64_t with_dead = 0;
  std::uint64_t removed = 0;                    ///< by orders, or because they broke down
  std::vector<physics::Removal> broken_bodies;  ///< of those the latter
  std::vector<core::RegionId> dead;  ///< nodes that another one holds for dead; they compute no state after it
  std::uint64_t applied = 0;         ///< orders, by bodies
  std::uint64_t severed = 0;         ///< contacts cut by a hand-off
  std::uint64_t bad_phases = 0;
  std::vector<std::pair<core::RegionId, node::SeenCollision>> wrong;  ///< late or missed, and who saw it
  std::vector<physics::Collision> contacts;                           ///< first contacts
  std::vector<core::Setpoints> effects;                               ///< of setpoints, as recorded
};

class CheckedRun {
 public:
  CheckedRun(const core::Scene& scene, const ClusterOptions& options);

  /// Runs until every live node has computed state `steps`, then lets the dust settle.
  Outcome run(core::Step steps);

  node::Node& node(std::uint32_t region) { return cluster_.node(region); }
  std::vector<node::HandOffRow> moves;
  /// Called after every state of every node, with the virtual time.
  std::function<void(node::Node& node, const node::StepReport& report, double now_s)> on_state;

 private:
  bool has_done(core::Step steps) const;
  void take(const lab::VirtualCluster::Event& event);
  void take_reports(std::uint32_t region);
  void take_report(core::RegionId region, const node::StepReport& report);
  void check_single_host();
  void end(core::RegionId region);
  void end_who_is_held_for_dead();
  void settle();
  void account();
  template <class Visit>
  void for_each_live(const Visit& visit);

  ClusterOptions options_;
  lab::VirtualCluster cluster_;
  std::set<core::BodyId> seen_, doubled_, with_dead_, removed_;
  std::map<core::BodyId, node::HandOffRow> last_departure_;
  Outcome outcome_;
};

/// The first state with other bits in the two runs; if there is none, the one after the last.
core::Step first_difference(const lab::Played& a, const lab::Played& b);

/// The same scene in one world.
Outcome run_central(const core::Scene& scene, ClusterOptions options, core::Step steps);

}  // namespace aurasim::test
