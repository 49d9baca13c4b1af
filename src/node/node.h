// One region's node: protocol, physics and mail, one step at a time (docs/design.md, "One step"). It reads the wall
// clock only to measure its own phases; the caller decides when to step. The same class runs in a process over DDS and,
// many at a time, inside a test in virtual time.
#pragma once

#include <cstdint>
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
#include "node/births.h"
#include "node/collision_watch.h"
#include "node/cuts.h"
#include "node/held_reports.h"
#include "node/ordered_scene.h"
#include "node/phase_clock.h"
#include "node/static_orders.h"
#include "node/step_report.h"
#include "node/time_spent.h"
#include "node/touches.h"
#include "physics/region_world.h"
#include "transport/transport.h"

namespace aurasim::node {

struct NodeSetup {
  core::ProtocolSettings protocol;
  physics::Settings physics;
  core::ControlRules control;
  std::vector<core::Setpoints> recorded;  ///< setpoints of an earlier run; each is received again in its state
  bool hash_states = true;
  PhaseClock clock = PhaseClock::kWall;
  /// If set, regions are coupled (physics/coupling.h), and there are no auras. Has to outlive the node.
  core::SeamMail* seams = nullptr;
};

/// Whether the records already hold the state that a run goes on from, with all bodies that joined it late.
enum class Recorded : std::uint8_t { kNo, kYes };

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
  /// After a redo, it also gathers once the others have said where their bodies are (Protocol::gather).
  bool ready();

  /// Computes the next state, or goes back to an earlier one where the run is to be computed again. Only when ready().
  /// Throws core::SeamsBroken if a coupled region is lost on the way; from then on this node is never ready().
  const StepReport& step();
  /// Reports that have become final with the last step, in order. Without AuraRules::redo this is the report of the
  /// last step. With it, a report is final once no alarm can question its state any more, and a hash is once no body
  /// can join its state any more. Valid until the next step.
  std::span<const StepReport> confirmed() const { return held_.given_out(); }
  /// Keeps state `last` for finish(), because the run may end or change after it.
  void keep(core::Step last);
  /// The newest confirmed state: no alarm can question it any more. Its report may be given out later.
  core::Step confirmed_step() const;
  /// To be called often while the run stands in the present state, which is then checked without a later one. Sends and
  /// takes in messages. True once all nodes have checked the state, and no pair has touched on two of them.
  bool stand();
  /// True if the run will go back to before the present state. A run that stands has to compute on until it does.
  bool is_going_back() const;
  /// The newest state that observers may be given: it is confirmed, or the run stood in it and all nodes have checked
  /// it. No redo for a pair changes it any more.
  core::Step shown_step() const;
  /// Ends the run. Precondition: state `last` is confirmed. Returns the reports up to `last` that have not been given
  /// out, and one more of state `last` with what has joined it since. If keep() named `last`, the world is put back to
  /// that state, with all bodies that were under way.
  std::span<const StepReport> finish(core::Step last);
  /// True once finish() has taken in the bodies that were under way.
  bool settled() const { return settled_; }
  /// The bodies of this region for the records of its end.
  BodiesAtEnd bodies_at_end();
  /// To be called when a node of the run has died. From then on no state is computed again, and late and missed
  /// collisions are counted as in a run without redo.
  void give_up_redo() { protocol_->give_up_alarms(); }
  /// How many redos the run has had.
  std::uint32_t redos() const { return setup_.protocol.redo; }
  /// Computing time since this node began, and how much of it went into redos.
  const TimeSpent& time_spent() const { return time_spent_; }

  /// Asks for this region's part of the world in state `step`. A state that has been computed already is ignored.
  void save(core::Step step) {
    if (step > current_step()) saved_.ask(step);
  }
  /// Takes the parts asked for with save() that are complete: their state is confirmed, and everything that was under
  /// way has arrived.
  std::vector<core::WorldCut> take_saved();
  /// This region's part of the world in the present state, for a run that is held. Empty while some message sent here
  /// up to that state has not arrived. A redo may still go back to before this state; then the part belongs to a world
  /// that no longer counts.
  std::optional<core::WorldCut> present_part();
  /// A part without bodies, with all orders that this node knows by now. It brings `earlier`, a saved world, up to
  /// date.
  core::WorldCut orders_now(const core::WorldCut& earlier) const;

  /// Makes an order of `action`, the request of a client. It is executed as soon as all nodes can have received it, or
  /// in state `at_step` if that is later. Only the one node that takes orders may call this.
  const core::Order& order(const core::Action& action, std::uint64_t request, core::Step at_step = 0);
  /// The order that a client's request has become, whichever node gave it. Null if no such order is known here, if it
  /// is no longer kept, or if it concerns the run as a whole.
  const core::Order* ordered(std::uint64_t request) const { return scene_.of_request(request); }
  /// Sequence of the newest order that has changed the scene; 0: none.
  std::uint64_t newest_scene_order() const { return scene_.newest_change(); }
  /// Receives a program's setpoints. They are applied wherever the bodies are by then. For statics, the node that takes
  /// orders makes an order for all nodes. Where all are sure to receive the setpoints before their state
  /// (`known_to_all`), and in runs with redo, the other nodes expect that order and go by it before it comes
  /// (core/static_moves.h).
  core::Heard hear(const core::Setpoints& setpoints, bool known_to_all = false);
  void use_meshes(MeshSource source) { scene_.use_meshes(std::move(source)); }
  /// From now on, reports contain what late bodies did before they joined (`states`) and the contact impulses
  /// (`contacts`). The simulation itself stays the same to the bit.
  void observe(bool states, bool contacts);
  /// The scene with all that orders have added to it.
  const core::Scene& scene() const { return scene_.scene(); }

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

  /// Changes to another map in the present state. Precondition: all bodies are where the new map wants them, or regions
  /// are coupled, and every node of the run changes in the same state. `map`, `transport` and `seams` must outlive the
  /// node; `seams` is null unless regions are coupled.
  const StepReport& take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                             transport::Transport& transport, core::SeamMail* seams);

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
  // A world comes in (node_start.cpp)
  void put_in(const Cut& part);
  void begin_state(Recorded recorded);
  void execute_saved(const core::WorldCut& world);
  core::ClusterState our_part();
  std::vector<core::RegionId> hosts_at_start(core::Snapshot all);
  void couple();

  // A step (node.cpp)
  void compute_and_keep();
  void take_mail();
  void compute_step();
  void meet_partners(core::Step n, std::span<const core::Introduction> introductions);
  void compute_state();
  void apply(const core::Changes& changes);
  void adopt(std::span<const core::Adoption* const> adoptions);
  void announce_births(core::Step state);
  void finish_state();
  void watch_collisions(const core::Snapshot& snapshot);
  void release(std::span<const core::Departure> departures);
  void hand_over(const core::Departure& departure, core::ClusterState cluster);

  // Rows of the report (node_report.cpp, node_control.cpp)
  void clear_report();
  void count(const core::Snapshot& snapshot);
  void note_removals();
  void note_arrivals(const core::Adoption& adoption);
  void note_moved();
  void note_made_up_contacts();
  bool stays(core::BodyId id) const;
  void note_effects();
  void note_effects_anew();
  void note_effects_on_arrivals();
  void note_left_behind(std::span<const core::BodyRecord> bodies, core::Step last);

  // History (node_redo.cpp, node_cut.cpp)
  bool may_go_back() const;
  void begin_to_stand();
  void learn_of_redos();
  bool redo_is_due() const;
  void take_cut();
  Cut cut(core::ChangedState memory = {});
  void forget_cuts();
  void order_redo();
  void put_back();
  void gather();
  void hold();
  void release_held(core::Step until);
  void confirm_all();
  void save_if_due();
  /// Tells of a state whether every cluster that was under way in it has arrived and joined by the time that `now` is
  /// computed.
  std::function<bool(core::Step)> whole_by(core::Step now) const;
  core::WorldCut part_of_world(Cut cut) const;
  void add_orders(core::WorldCut& part, core::Step after) const;
  void forget_setpoints();
  void note_late_words(core::Step from, core::Step until);

  // Orders (node_orders.cpp, node_statics.cpp)
  bool leads() const;
  const core::Order& give(core::Order order);
  void complete(core::Order& order) const;
  void execute(const core::Order& order);
  bool can_go(std::span<const core::StaticSetpoint> statics) const;
  bool believes_programs() const;
  core::Heard hear_of_statics(const core::Setpoints& setpoints, core::Heard heard, bool known_to_all);
  void expect(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request);
  core::Heard order_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request, bool at_once);
  const core::Order& give_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request);
  void expect_recorded_moves();
  void order_recorded_moves();
  void give_up_expected();
  void doubt(core::Step step);
  void note_moves();

  /// The world that the run began with on this node. Kept as long as a redo may go back to it.
  struct Beginning {
    core::WorldCut world;
    std::vector<core::BodyRecord> born_soon;  ///< announced neither in the world nor later
  };

  NodeSetup setup_;
  OrderedScene scene_;
  const core::RegionMap* map_;
  transport::Transport* transport_;
  std::unique_ptr<core::ClearanceQuery> clearance_;
  std::optional<core::Protocol> protocol_;  ///< never empty; replaced when the run goes back or the map changes
  // If regions are coupled:
  std::optional<core::BlockOwners> owners_;
  std::optional<core::SeamPartners> partners_;  ///< of the state that is computed
  physics::RegionWorld world_;
  CollisionWatch watch_;
  core::Inbox inbox_;
  ToBeBorn to_be_born_;
  Injections injections_;
  Touches touches_;
  Cuts cuts_;
  SavedStates saved_;
  HeldReports held_;
  std::optional<Beginning> beginning_;
  bool is_broken_ = false;  ///< a coupled region was lost in the middle of a step
  bool settled_ = false;
  bool is_observed_ = false;
  std::vector<core::Order> redos_;   ///< ordered and not carried out yet, in sequence
  std::uint64_t last_redo_ = 0;      ///< sequence of the newest of redos_ so far
  std::uint32_t lonely_worlds_ = 0;  ///< number of worlds in which clusters have made up states so far
  StepReport gathered_;              ///< rows of those that gather() has sent away, for the next report
  bool is_changing_ = false;         ///< this node has ordered a change of the run; an order given now would be lost
  StaticOrders statics_;
  LateWords late_words_;
  core::Epoch first_epoch_ = 0;  ///< epoch that new bodies get
  double mail_s_ = 0;            ///< time spent with the mail since the last step
  TimeSpent time_spent_;
  StepReport report_;
};

}  // namespace aurasim::node
