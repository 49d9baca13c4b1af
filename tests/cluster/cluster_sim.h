// A whole cluster of nodes in one process, in virtual time, over a seeded network that misbehaves. The real protocol,
// the real physics; only clock and wire are simulated. Checks the invariants of docs/design.md, "Exactly once",
// on every step.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "node/node.h"
#include "transport/memory_transport.h"

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

struct ClusterOptions {
  core::RegionMap map = core::RegionMap::columns(1, 1);
  core::AuraRules aura;
  int friction_directions = 1;
  physics::Solver solver = physics::Solver::kSequentialImpulse;
  int solver_iterations = 10;
  core::SyncMode sync = core::SyncMode::kBounded;
  transport::Faults faults;
  std::uint64_t seed = 1;
  double frame_s = 0.004;     ///< of every node and step
  double frame_jitter_s = 0;  ///< uniform extra
  double neighbour_distance_m = 1e9;
  core::Step shuffle_ranks_steps = 0;  ///< who outranks whom changes about so often
  std::optional<Crash> crash;
  std::optional<LinkCut> cut;
  core::Step overrun = 0;  ///< region 0 ends in the last state; the others go so many on, if they need not wait for it
  std::vector<core::Setpoints> recorded;  ///< of an earlier run
  std::vector<std::pair<core::Step, core::Action>>
      orders;                  ///< given to region 0 before state 0, by the state they name
  bool over_the_wire = false;  ///< what the wire would refuse arrives as a refusal
};

struct Outcome {
  std::uint64_t hand_offs = 0;  ///< bodies
  std::uint64_t late = 0;
  std::uint64_t missed = 0;
  std::uint64_t unflagged = 0;  ///< late or missed, without a violation before
  std::uint64_t violations = 0;
  std::uint64_t late_words = 0;  ///< of those: heard too late, and computed again over
  std::uint64_t thrashed = 0;
  std::uint64_t doubled = 0;  ///< bodies ever seen on two live nodes at once
  std::uint64_t lost = 0;
  std::uint64_t with_dead = 0;
  std::uint64_t removed = 0;             ///< by orders, or because they broke down
  std::vector<physics::Removal> broken;  ///< of those the latter
  std::vector<core::RegionId> dead;      ///< nodes that another one holds for dead; they compute no state after it
  std::uint64_t applied = 0;             ///< orders, by bodies
  std::uint64_t severed = 0;             ///< contacts cut by a hand-off
  std::uint64_t redos = 0;               ///< how often the run was put back
  std::uint64_t again = 0;               ///< states computed once more because of that
  std::uint64_t bad_phases = 0;
  std::size_t largest_cluster = 0;
  double slowest_s = 0;                                               ///< virtual time at the end
  std::vector<std::pair<core::RegionId, node::SeenCollision>> wrong;  ///< late or missed, and who saw it
  std::vector<physics::Collision> contacts;                           ///< first contacts
  std::vector<core::Setpoints> effects;                               ///< of setpoints, as recorded
  std::vector<std::uint64_t> hash;  ///< by step; only complete if no node is held for dead
};

class ClusterSim {
 public:
  ClusterSim(const core::Scene& scene, const ClusterOptions& options);
  ~ClusterSim();

  /// Runs until every live node has computed state `steps`, then lets the dust settle.
  Outcome run(core::Step steps);

  node::Node& node(std::uint32_t region) { return *members_[region].node; }
  std::vector<node::HandOffRow> moves;
  /// Called after every state of every node, with the virtual time.
  std::function<void(node::Node& node, const node::StepReport& report, double now_s)> on_state;

 private:
  struct Member {
    std::unique_ptr<transport::Transport> wire;  ///< with over_the_wire
    std::unique_ptr<node::Node> node;
    double busy_until_s = 0;
    bool alive = true;
  };

  void cut_off(const LinkCut& cut);
  void step_if_due(Member& member, core::Step last);
  bool has_done(const node::Node& node, core::Step steps) const;
  void take_reports(Member& member);
  void take_report(Member& member, const node::StepReport& report);
  void check_single_host();
  bool is_held_for_dead(core::RegionId region) const;
  void maybe_crash(Member& member);
  void end(Member& member);
  void settle();
  void account(Outcome& outcome);
  double chance();

  const core::Scene& scene_;
  ClusterOptions options_;
  std::unique_ptr<transport::MemoryNetwork> network_;
  std::vector<Member> members_;
  std::uint64_t random_;
  std::set<core::BodyId> seen_, doubled_, with_dead_, removed_;
  std::map<core::BodyId, node::HandOffRow> last_departure_;
  Outcome outcome_;
};

/// The same scene in one world.
Outcome run_central(const core::Scene& scene, ClusterOptions options, core::Step steps);

}  // namespace aurasim::test
