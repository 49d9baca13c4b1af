// One region's node: protocol, physics and mail, one step at a time (docs/design.md, "One step"). Knows no wall clock
// but for measuring its own phases; the caller says when to step. The same class runs in a process over DDS and, many
// at a time, inside a test in virtual time.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/protocol.h"
#include "core/region_map.h"
#include "core/scene.h"
#include "core/world_cut.h"
#include "node/collision_watch.h"
#include "node/phase_clock.h"
#include "physics/region_world.h"
#include "transport/transport.h"

namespace aurasim::node {

/// What a node needs to go back to a state: a part of a consistent cut through the run (docs/design.md, "The cut").
struct Cut {
  core::Step step = 0;
  core::ClusterState bodies;            ///< hosted here, after those that left in this state
  std::vector<core::Adoption> joining;  ///< sent here in this state or before, and not here yet
  std::vector<core::Order> to_spawn;    ///< received so far, also after the cut
  std::vector<std::uint64_t> next_injection;
  core::RankClaimer claimer;
  CollisionCounts collisions;
};

struct NodeSetup {
  core::ProtocolSettings protocol;
  physics::Settings physics;
  core::ControlRules control;
  std::vector<core::Setpoints> recorded;  ///< of an earlier run, to be heard in their states
  bool hash_states = true;
  PhaseClock clock = PhaseClock::kWall;
};

/// One body's change of host, as the receiver or (on reclaim) the sender saw it.
struct HandOffRow {
  core::Step stamp = 0;   ///< state in which it left
  core::Step joined = 0;  ///< state in whose computation it takes part first; 0 in the sender's rows
  core::BodyId body{};
  core::Epoch epoch = 0;  ///< the new one
  core::RegionId source{};
  core::RegionId destination{};
  core::HandOffReason reason{};
  bool reclaimed = false;
  bool touched = false;  ///< it had a contact since its last change of host (sender's rows)

  bool is_pull() const { return reason == core::HandOffReason::kAuraCollision; }
};

/// Has the state that a run goes on from been recorded, with all that joined it late?
enum class Recorded : std::uint8_t { kNo, kYes };

/// A body's first host, and the state in which it exists first.
struct Birth {
  core::BodyId body{};
  core::Step birth = 0;
};

struct HashPart {
  core::Step step = 0;
  std::uint64_t sum = 0;
};

/// A client's request that has taken effect here.
struct Applied {
  std::uint64_t request = 0;
  core::Step step = 0;                    ///< the first state that shows the effect
  std::optional<core::ObjectRef> object;  ///< the body that it has made
};

/// What has been in effect on bodies and joints hosted here, from a state on that each names: what has changed, and all
/// that is in effect on those that have come. On those that have left nothing is, unless their next host says so.
struct Effects {
  std::vector<core::BodyEffect> bodies;
  std::vector<core::JointEffect> joints;
  std::vector<core::StaticEffect> statics;  ///< told by the node that takes orders
};

/// Seconds spent in the phases of one step, by NodeSetup::clock.
struct Durations {
  double physics_s = 0;    ///< apply, step, snapshot, release
  double protocol_s = 0;   ///< receive, observe
  double transport_s = 0;  ///< take, decode, encode, send
  double watch_s = 0;      ///< late and missed collisions, counts: for the report alone
  double cut_s = 0;        ///< keeping the state, to be able to come back to it
};

/// The mesh of this content, for this use, if the process has it.
using MeshSource = std::function<std::optional<core::Shape>(const core::MeshRef&)>;

/// A state that was made up for bodies that have joined late.
struct MadeUp {
  core::Step step = 0;
  std::vector<core::BodyRecord> bodies;        ///< ascending id
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)
  std::vector<core::BodyId> gone;              ///< of those that were handed over: taken out on the way. Ascending
};

/// What one step did. Valid until the next.
struct StepReport {
  core::Step step = 0;
  Durations durations;
  std::size_t bodies = 0;
  std::size_t awake = 0;
  std::size_t foreign_auras = 0;
  std::size_t projecting = 0;
  std::size_t largest_cluster = 0;
  std::vector<Birth> births;                ///< bodies that this node has announced or taken over at the start
  std::vector<physics::Removal> removals;   ///< bodies taken out, by orders or because they broke down
  std::vector<core::Order> orders;          ///< received
  std::vector<Applied> applied;             ///< requests that were applied here
  std::vector<physics::Declined> declined;  ///< and those that bodies here could not bear
  Effects effects;
  std::uint64_t unbearable = 0;  ///< setpoints that would have made a body faster than may be
  std::vector<HandOffRow> departures;
  std::vector<core::BodyRecord> departed;  ///< as `departures`: the states in which they left, old epochs
  std::vector<core::BodyId> let_go;        ///< gave way to copies with higher epochs
  std::vector<HandOffRow> arrivals;
  std::vector<MadeUp> made_up;  ///< while somebody observes
  std::vector<SeenCollision> collisions;
  std::vector<HashPart> hash;  ///< this state, and states made up for bodies that joined
  std::vector<core::Violation> violations;
  std::uint64_t violations_total = 0;            ///< since the start
  std::optional<core::Step> put_back_from;       ///< the run has gone back to `step`
  std::vector<core::TogetherPair> put_back_for;  ///< the pairs that come to one host in time now
};

/// What a scene begins with, as a saved world: all that Node::start() knows by itself.
core::WorldCut first_world(const core::Scene& scene, int lookahead, double step_s);

class Node {
 public:
  /// Map and transport outlive the node. The scene is copied: orders add to it.
  Node(const NodeSetup& setup, const core::Scene& scene, const core::RegionMap& map, transport::Transport& transport);

  /// Takes the bodies of state 0 that are this region's and publishes them. Once, before anything else.
  const StepReport& start();
  /// Instead: goes on from a saved world, of which every node of the run is given the whole. Throws
  /// std::invalid_argument if it is none of this scene.
  const StepReport& start(core::WorldCut world, Recorded recorded = Recorded::kNo);

  /// Takes in the mail. True when the next state may be computed.
  bool ready();

  /// Computes the next state, or goes back to an earlier one where the run is to be computed again. Only when ready().
  const StepReport& step();
  /// The reports that can be relied on since the last step, in order: with AuraRules::redo those of states that nothing
  /// can come to question any more, with the hashes of states that nothing can join any more; otherwise the last one.
  /// Valid until the next step.
  std::span<const StepReport> confirmed() const { return confirmed_; }
  /// The run may end after state `last`, or change: finish() will need it.
  void keep(core::Step last);
  /// No alarm can come to question this state any more. Reports follow later.
  core::Step confirmed_step() const;
  /// Once state `last` is confirmed, and the run is over: the reports up to it that have not been given out, and one
  /// more of state `last` with what has joined it since. The world is that of state `last`, with all that was under
  /// way, if keep() named it.
  std::span<const StepReport> finish(core::Step last);
  /// finish() has taken in what was under way.
  bool settled() const { return settled_; }
  /// Somewhere a node has died: nothing can be computed again any more, and collisions are judged as without a redo.
  void give_up_redo() { protocol_->give_up_alarms(); }
  /// How often the run has gone back.
  std::uint32_t redos() const { return setup_.protocol.redo; }

  /// This region's part of the world in state `step` is wanted, which has not been computed yet.
  void save(core::Step step);
  /// The parts that are complete: nothing can come to question them any more, and all that was under way is here.
  std::vector<core::WorldCut> take_saved();
  /// This region's part of the world in the present state, while the run stands; nothing: some of what was sent here up
  /// to then has not come. A redo may still go back to before this state: then the part is of a world that was void.
  std::optional<core::WorldCut> present_part() const;
  /// What this node knows by now that a world saved in an earlier state does not: a part of it without bodies, with all
  /// orders.
  core::WorldCut orders_now(const core::WorldCut& earlier) const;

  /// Orders the world to do something, as soon as all nodes can have received it, or in state `at_step` if that is
  /// later. Only on the one node that takes orders.
  const core::Order& order(const core::Action& action, std::uint64_t request, core::Step at_step = 0);
  /// What has become of a client's request, if it has been ordered, here or elsewhere: as far as is known here, and not
  /// longer than orders are kept. Null: nothing is known. Not of orders about the run as a whole.
  const core::Order* ordered(std::uint64_t request) const;
  /// Sequence of the newest order that has changed the scene; 0: none.
  std::uint64_t newest_scene_order() const { return newest_scene_order_; }
  /// A program's word. Takes effect wherever the bodies are by then. What it says of statics the node that takes orders
  /// orders for all; where states are computed again if need be, the others expect it (core/static_moves.h).
  core::Heard hear(const core::Setpoints& setpoints);
  void use_meshes(MeshSource source) { meshes_ = std::move(source); }
  /// Whether somebody wants to know what late bodies have done before they came, and what presses on what. In the steps
  /// from now on; it changes no bit.
  void observe(bool states, bool contacts);
  /// As it has grown.
  const core::Scene& scene() const { return scene_; }

  /// What bodies on their way here do up to the present state, whose hand-offs have come: they make it up when they
  /// join, to the same bits. Changes nothing. By hand-off, each ascending by state.
  std::vector<MadeUp> foresee();
  /// How many hand-offs have come that do not take effect yet.
  std::size_t hand_offs_to_come() const { return protocol_->intake().to_come().size(); }
  /// Everything is here that others have sent to this node in states up to `last`.
  bool has_all_until(core::Step last) const;

  /// After the last step: may what is still under way be taken in?
  bool ready_to_settle();
  /// Takes in the bodies that are still under way to this region, so that every state's hash is whole.
  const StepReport& settle();

  /// Another map, in the state that has been computed. All bodies are where the new map wants them, and every node of
  /// the run does the same. Map and transport outlive the node.
  const StepReport& take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                             transport::Transport& transport);

  core::RegionId region() const { return setup_.protocol.self; }
  /// Of the last step.
  const StepReport& report() const { return report_; }
  core::Step current_step() const { return world_.step_number(); }
  const core::Protocol& protocol() const { return *protocol_; }
  const physics::RegionWorld& world() const { return world_; }
  core::Protocol& protocol() { return *protocol_; }
  physics::RegionWorld& world() { return world_; }
  const CollisionWatch& collision_watch() const { return watch_; }
  /// Messages of a later generation, for the node that takes over after a reset.
  core::Inbox& mail() { return inbox_; }
  void accept_early_mail(core::Inbox mail) { inbox_ = std::move(mail); }

 private:
  void take_mail();
  void note_removals();
  bool stays(core::BodyId id) const;
  void note_effects();
  void note_effects_anew();
  void note_effects_on_arrivals();
  void note_left_behind(const core::ClusterState& cluster);
  void forget_setpoints();
  bool can_go(std::span<const core::StaticSetpoint> statics) const;
  bool leads() const;
  bool believes_programs() const;
  void note_late_words(core::Step from, core::Step until);
  core::Heard hear_of_statics(const core::Setpoints& setpoints, core::Heard heard);
  void expect(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request);
  core::Heard order_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request);
  void expect_recorded_moves();
  void order_recorded_moves();
  void doubt(core::Step step);
  void give_up_expected();
  void note_moves();
  const core::Order& give(core::Order order);
  const core::Order& give_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request);
  void clear_report();
  void host_initial_bodies();
  std::vector<core::BodyRecord> initial_bodies();
  std::vector<core::RegionId> hosts_at_start(core::Snapshot all);
  void announce_births(core::Step state);
  void complete(core::Order& order) const;
  void heed(const core::Order& order);
  void heed_saved();
  void remember(const core::Order& order);
  const core::Order* newest_spawn() const;
  core::Step births_known_at_start() const;
  core::ClusterState our_part();
  void note_arrived();
  void save_if_due();
  core::WorldCut part_of_world(Cut cut) const;
  void add_orders(core::WorldCut& part, core::Step after) const;
  void announce_spawns(core::Step birth);
  void apply(const core::Changes& changes);
  void finish_state();
  void watch_collisions(const core::Snapshot& snapshot);
  void note_contacts(const core::Snapshot& snapshot);
  void note_made_up_contacts();
  void note_arrivals(const core::Adoption& adoption);
  void release(std::span<const core::Departure> departures);
  void hand_over(const core::Departure& departure, core::ClusterState cluster);
  bool take_touched(core::BodyId id);
  void count(const core::Snapshot& snapshot);
  void compute_step();
  void adopt(const core::Adoption& adoption, std::uint32_t nth);
  bool redo_is_due() const { return redo_ && redo_->at_step <= current_step(); }
  void put_back();
  void take_cut();
  Cut cut() const;
  void go_back_to(const Cut& cut);
  void forget_cuts();
  void order_redo();
  const Cut& cut_before(core::Step touch, std::size_t farther) const;
  void hold(StepReport report);
  void release_reports(core::Step until);
  void release_hashes(core::Step until, StepReport& report);
  void confirm_all();

  NodeSetup setup_;
  core::Scene scene_;
  MeshSource meshes_;
  const core::RegionMap* map_;
  transport::Transport* transport_;
  std::unique_ptr<core::ClearanceQuery> clearance_;
  std::optional<core::Protocol> protocol_;  ///< always there; another one with another map
  physics::RegionWorld world_;
  CollisionWatch watch_;
  core::Inbox inbox_;
  std::vector<core::Order> to_spawn_;
  std::vector<std::uint64_t> next_injection_;  ///< by injector: first index not yet announced
  struct Touch {
    core::BodyId id{};
    bool touched = false;  ///< had a contact since it came here
  };
  std::vector<Touch> touched_, touched_before_;  ///< ascending id: of the last state, and of the one before it
  std::deque<Cut> cuts_;                         ///< ascending
  struct Saving {
    core::Step step = 0;
    std::optional<Cut> cut;
    bool is_whole = false;    ///< what was under way has arrived
    bool is_the_end = false;  ///< named by keep(): not for others
  };
  std::vector<Saving> saving_;
  std::vector<core::Order> orders_;  ///< in sequence: for whoever goes on from a saved world
  std::uint64_t newest_scene_order_ = 0;
  std::size_t orders_kept_ = 1024;            ///< those among them that may not be forgotten, at most
  std::size_t first_own_shape_ = 0;           ///< of the scene, beyond those of its file
  std::optional<core::WorldCut> begun_with_;  ///< as long as a redo may come back to it
  std::vector<core::BodyRecord> born_soon_;   ///< announced neither there nor later
  bool settled_ = false;
  bool is_observed_ = false;
  std::optional<core::Order> redo_;  ///< not yet due
  bool redo_is_ordered_ = false;     ///< by us
  bool is_changing_ = false;         ///< we have ordered what changes the run: what is ordered now would be lost
  std::vector<core::StaticEffect> recorded_moves_;  ///< of setup_.recorded, ascending step
  std::size_t next_recorded_move_ = 0;
  core::Step moves_ordered_for_ = -1;  ///< the state in which we have ordered moves_ordered_
  std::size_t moves_ordered_ = 0;
  struct LateWord {
    core::Step at_step = 0;  ///< that it named
    core::Step heard = 0;    ///< the newest state by then
  };
  std::deque<LateWord> late_words_;  ///< the last ones
  std::vector<core::Step> doubted_;  ///< states in which the run was put back since a static was elsewhere
  core::Epoch first_epoch_ = 0;      ///< of bodies that are new
  std::size_t stubborn_ = 0;         ///< redos in a row that have not brought a pair together
  std::deque<StepReport> held_;      ///< not confirmed yet
  struct HeldHash {
    core::Step told_in = 0;     ///< report
    bool told_by_redo = false;  ///< of what has joined anew
    HashPart part;
  };
  std::vector<HeldHash> hash_parts_;  ///< of states that may get more
  core::Step released_ = -1;          ///< reports up to this one have been given out
  core::Step hashed_ = -1;            ///< likewise, the hashes of states
  std::vector<StepReport> confirmed_;
  double mail_s_ = 0;  ///< time spent with the mail since the last step
  StepReport report_;
};

}  // namespace aurasim::node
