// One region's node: protocol, physics and mail, one step at a time (docs/design.md, "One step"). It reads the wall
// clock only to measure its own phases; the caller decides when to step. The same class runs in a process over DDS and,
// many at a time, inside a test in virtual time.
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
  core::ClusterState bodies;            ///< hosted here; those that left in this state are taken out
  std::vector<core::Adoption> joining;  ///< clusters sent here in this state or before that have not joined yet
  std::vector<core::Order> to_spawn;    ///< spawn orders received so far, also those received after the cut
  std::vector<std::uint64_t> next_injection;
  core::RankClaimer claimer;
  CollisionCounts collisions;
};

struct NodeSetup {
  core::ProtocolSettings protocol;
  physics::Settings physics;
  core::ControlRules control;
  std::vector<core::Setpoints> recorded;  ///< setpoints of an earlier run; each is received again in its state
  bool hash_states = true;
  PhaseClock clock = PhaseClock::kWall;
};

/// One body's change of host, as its sender or its receiver saw it.
struct HandOffRow {
  core::Step stamp = 0;   ///< state in which it left
  core::Step joined = 0;  ///< state in whose computation it takes part first; 0 in the sender's rows
  core::BodyId body{};
  core::Epoch epoch = 0;  ///< epoch after the change
  core::RegionId source{};
  core::RegionId destination{};
  core::HandOffReason reason{};
  bool touched = false;  ///< the body had a contact since its last change of host (sender's rows)

  bool is_pull() const { return reason == core::HandOffReason::kAuraCollision; }
};

/// Whether the records already hold the state that a run goes on from, with all bodies that joined it late.
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
  std::optional<core::ObjectRef> object;  ///< the body that the request has made
};

/// Setpoints in effect on bodies and joints hosted here. Each entry names the state from which on it holds. Listed are
/// the changes, and for bodies that have arrived all that is in effect on them. An entry without a value ends a
/// setpoint: each body that leaves gets one, and its next host reports anew what is in effect.
struct Effects {
  std::vector<core::BodyEffect> bodies;
  std::vector<core::JointEffect> joints;
  std::vector<core::StaticEffect> statics;  ///< filled only by the node that takes orders
};

/// Seconds spent in the phases of one step, by NodeSetup::clock.
struct Durations {
  double physics_s = 0;    ///< apply, step, snapshot, release
  double protocol_s = 0;   ///< receiving messages, interest matching
  double transport_s = 0;  ///< take, decode, encode, send
  double watch_s = 0;      ///< late and missed collisions, and counts; only the report needs them
  double cut_s = 0;        ///< keeping the state, to go back to it or to save it
  double hash_s = 0;       ///< hashing the state. Hashes of states made up for late bodies count as physics
};

/// Returns the shape that a mesh reference names, or nothing if the process does not have that mesh.
using MeshSource = std::function<std::optional<core::Shape>(const core::MeshRef&)>;

/// A state computed again for bodies that joined late, which they had missed on their way.
struct MadeUp {
  core::Step step = 0;
  std::vector<core::BodyRecord> bodies;        ///< ascending id
  std::vector<core::ContactImpulse> contacts;  ///< ascending (a, b)
  std::vector<core::BodyId> gone;              ///< handed-over bodies that were removed before they joined; ascending
};

/// Result of one step. Valid until the next step.
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
  std::vector<core::Order> orders;          ///< orders received in this step
  std::vector<Applied> applied;             ///< requests that were applied here
  std::vector<physics::Declined> declined;  ///< requests refused because a body here could not bear them
  Effects effects;
  std::uint64_t unbearable = 0;  ///< number of setpoints refused because a body would have become too fast
  std::vector<HandOffRow> departures;
  std::vector<core::BodyRecord> departed;  ///< the bodies of `departures` as they left, with old epochs
  std::vector<core::BodyId> let_go;        ///< bodies dropped here because another node hosts them under a higher epoch
  std::vector<HandOffRow> arrivals;
  std::vector<MadeUp> made_up;  ///< filled only while somebody observes
  std::vector<SeenCollision> collisions;
  std::vector<HashPart> hash;  ///< hash parts of this state, and of states made up for bodies that joined
  std::vector<core::Violation> violations;
  std::uint64_t violations_total = 0;            ///< since the start
  std::optional<core::Step> put_back_from;       ///< set after a redo: the run has gone back from this state to `step`
  std::vector<core::TogetherPair> put_back_for;  ///< pairs of the redo; they now come to one host in time
};

/// The world in state 0 as a saved world: the scene's bodies, and the injected ones that are born before anybody could
/// announce them. `step_s`: duration of a step in seconds.
core::WorldCut first_world(const core::Scene& scene, int lookahead, double step_s);

class Node {
 public:
  /// `map` and `transport` must outlive the node. The scene is copied, because orders add to it.
  Node(const NodeSetup& setup, const core::Scene& scene, const core::RegionMap& map, transport::Transport& transport);

  /// Takes the bodies of state 0 that are this region's and publishes them. Once, before anything else.
  const StepReport& start();
  /// Starts from a saved world instead of state 0. Every node of the run is given the whole world and takes its part.
  /// Throws std::invalid_argument if the world does not belong to this scene.
  const StepReport& start(core::WorldCut world, Recorded recorded = Recorded::kNo);

  /// Takes in the messages that have arrived. True when the next state may be computed.
  bool ready();

  /// Computes the next state, or goes back to an earlier one where the run is to be computed again. Only when ready().
  const StepReport& step();
  /// Reports that have become final with the last step, in order. Without AuraRules::redo this is the report of the
  /// last step. With it, a report is final once no alarm can question its state any more, and a hash is once no body
  /// can join its state any more. Valid until the next step.
  std::span<const StepReport> confirmed() const { return confirmed_; }
  /// Keeps state `last` for finish(), because the run may end or change after it.
  void keep(core::Step last);
  /// The newest confirmed state: no alarm can question it any more. Its report may be given out later.
  core::Step confirmed_step() const;
  /// Ends the run. Precondition: state `last` is confirmed. Returns the reports up to `last` that have not been given
  /// out, and one more of state `last` with what has joined it since. If keep() named `last`, the world is put back to
  /// that state, with all bodies that were under way.
  std::span<const StepReport> finish(core::Step last);
  /// True once finish() has taken in the bodies that were under way.
  bool settled() const { return settled_; }
  /// To be called when a node of the run has died. From then on no state is computed again, and late and missed
  /// collisions are counted as in a run without redo.
  void give_up_redo() { protocol_->give_up_alarms(); }
  /// How many redos the run has had.
  std::uint32_t redos() const { return setup_.protocol.redo; }

  /// Asks for this region's part of the world in state `step`. A state that has been computed already is ignored.
  void save(core::Step step);
  /// Takes the parts asked for with save() that are complete: their state is confirmed, and everything that was under
  /// way has arrived.
  std::vector<core::WorldCut> take_saved();
  /// This region's part of the world in the present state, for a run that is held. Empty while some message sent here
  /// up to that state has not arrived. A redo may still go back to before this state; then the part belongs to a world
  /// that no longer counts.
  std::optional<core::WorldCut> present_part() const;
  /// A part without bodies, with all orders that this node knows by now. It brings `earlier`, a saved world, up to
  /// date.
  core::WorldCut orders_now(const core::WorldCut& earlier) const;

  /// Makes an order of `action`, the request of a client. It is executed as soon as all nodes can have received it, or
  /// in state `at_step` if that is later. Only the one node that takes orders may call this.
  const core::Order& order(const core::Action& action, std::uint64_t request, core::Step at_step = 0);
  /// The order that a client's request has become, whichever node gave it. Null if no such order is known here, if it
  /// is no longer kept, or if it concerns the run as a whole.
  const core::Order* ordered(std::uint64_t request) const;
  /// Sequence of the newest order that has changed the scene; 0: none.
  std::uint64_t newest_scene_order() const { return newest_scene_order_; }
  /// Receives a program's setpoints. They are applied wherever the bodies are by then. For statics, the node that takes
  /// orders makes an order for all nodes; in runs with redo the other nodes expect that order and go by it before it
  /// comes (core/static_moves.h).
  core::Heard hear(const core::Setpoints& setpoints);
  void use_meshes(MeshSource source) { meshes_ = std::move(source); }
  /// From now on, reports contain what late bodies did before they joined (`states`) and the contact impulses
  /// (`contacts`). The simulation itself stays the same to the bit.
  void observe(bool states, bool contacts);
  /// The scene with all that orders have added to it.
  const core::Scene& scene() const { return scene_; }

  /// States up to the present one of bodies whose hand-offs have arrived but that have not joined yet. When they join,
  /// they make up the same states to the same bits. The world does not change. Grouped by hand-off, each group
  /// ascending by state.
  std::vector<MadeUp> foresee();
  /// Number of hand-offs that have arrived but do not take effect yet.
  std::size_t hand_offs_to_come() const { return protocol_->intake().to_come().size(); }
  /// True if everything that others sent to this node in states up to `last` has arrived.
  bool has_all_until(core::Step last) const;

  /// To be called after the last step. True when the bodies still under way may be taken in.
  bool ready_to_settle();
  /// Takes in the bodies that are still under way to this region, so that every state's hash is whole.
  const StepReport& settle();

  /// Changes to another map in the present state. Precondition: all bodies are where the new map wants them, and every
  /// node of the run changes in the same state. `map` and `transport` must outlive the node.
  const StepReport& take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                             transport::Transport& transport);

  core::RegionId region() const { return setup_.protocol.self; }
  /// Report of the last step.
  const StepReport& report() const { return report_; }
  core::Step current_step() const { return world_.step_number(); }
  const core::Protocol& protocol() const { return *protocol_; }
  const physics::RegionWorld& world() const { return world_; }
  core::Protocol& protocol() { return *protocol_; }
  physics::RegionWorld& world() { return world_; }
  const CollisionWatch& collision_watch() const { return watch_; }
  /// The inbox with messages of a later generation, for the node that takes over after a reset.
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
  bool may_go_back() const;
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
  std::optional<core::Protocol> protocol_;  ///< never empty; replaced when the map changes
  physics::RegionWorld world_;
  CollisionWatch watch_;
  core::Inbox inbox_;
  std::vector<core::Order> to_spawn_;
  std::vector<std::uint64_t> next_injection_;  ///< per injector, the first index not yet announced
  struct Touch {
    core::BodyId id{};
    bool touched = false;  ///< had a contact since it came here
  };
  std::vector<Touch> touched_, touched_before_;  ///< ascending id: of the last state, and of the one before it
  std::deque<Cut> cuts_;                         ///< ascending
  struct Saving {
    core::Step step = 0;
    std::optional<Cut> cut;
    bool is_whole = false;    ///< the bodies that were under way have arrived
    bool is_the_end = false;  ///< named by keep(); take_saved() does not hand it out
  };
  std::vector<Saving> saving_;
  std::vector<core::Order> orders_;  ///< in sequence; a saved world contains them
  std::uint64_t newest_scene_order_ = 0;
  std::size_t orders_kept_ = 1024;            ///< upper bound of those in orders_ that may not be forgotten
  std::size_t first_own_shape_ = 0;           ///< index of the first shape that an order added to the scene's file
  std::optional<core::WorldCut> begun_with_;  ///< kept as long as a redo may go back to it
  std::vector<core::BodyRecord> born_soon_;   ///< bodies of begun_with_ announced neither in the saved world nor later
  bool settled_ = false;
  bool is_observed_ = false;
  std::optional<core::Order> redo_;  ///< a redo that has been ordered and is not due yet
  bool redo_is_ordered_ = false;     ///< this node has ordered redo_
  bool is_changing_ = false;         ///< this node has ordered a change of the run; an order given now would be lost
  std::vector<core::StaticEffect> recorded_moves_;  ///< of setup_.recorded, ascending step
  std::size_t next_recorded_move_ = 0;
  core::Step moves_ordered_for_ = -1;  ///< the state in which we have ordered moves_ordered_
  std::size_t moves_ordered_ = 0;
  struct LateWord {
    core::Step at_step = 0;  ///< the state that the setpoints named
    core::Step heard = 0;    ///< the newest state when they were received
  };
  std::deque<LateWord> late_words_;  ///< the last ones
  std::vector<core::Step> doubted_;  ///< states from which the run went back because a static was elsewhere
  core::Epoch first_epoch_ = 0;      ///< epoch that new bodies get
  std::size_t stubborn_ = 0;         ///< number of redos in a row that have not brought a pair together
  std::deque<StepReport> held_;      ///< not confirmed yet
  struct HeldHash {
    core::Step told_in = 0;     ///< state of the report that had it
    bool told_by_redo = false;  ///< a redo's report had it: bodies joined anew
    HashPart part;
  };
  std::vector<HeldHash> hash_parts_;  ///< hash parts of states that may get more parts
  core::Step released_ = -1;          ///< reports up to this one have been given out
  core::Step hashed_ = -1;            ///< hashes of states up to this one have been given out
  std::vector<StepReport> confirmed_;
  double mail_s_ = 0;  ///< time spent with the mail since the last step
  StepReport report_;
};

}  // namespace aurasim::node
