// Aura Projection on one node: decides what it publishes and which bodies change host, from what its neighbours
// publish. No clock, thread, socket or physics in here: time, messages and snapshots are passed in, so a whole cluster
// of nodes can run inside one test. One step of a node (docs/design.md, "One step"):
//   receive(n)         ->  bodies to adopt or to let go          [physics computes state n]
//   observe(snapshot)  ->  auras, clusters, bodies to release    [physics takes them out]
//   hand_over(...)     ->  hand-offs in the outbox
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/handoff.h"
#include "core/intake.h"
#include "core/interest_matching.h"
#include "core/introductions.h"
#include "core/listening.h"
#include "core/messages.h"
#include "core/nearness.h"
#include "core/order_log.h"
#include "core/projection.h"
#include "core/redo.h"
#include "core/region_map.h"
#include "core/standing.h"
#include "core/state_check.h"
#include "core/vicinity.h"
#include "core/violation.h"

namespace aurasim::core {

struct ProtocolSettings {
  RegionId self{};
  Generation generation = 0;
  std::uint32_t redo = 0;  ///< how often this generation has been put back
  SyncMode sync = SyncMode::kBounded;
  AuraRules aura;
  double neighbour_distance_m = 0;      ///< regions at most this far apart listen to each other
  const BlockOwners* owners = nullptr;  ///< if regions are coupled; has to outlive the protocol
  Step start = 0;                       ///< the first state that is passed to observe()
  std::uint64_t last_order = 0;         ///< orders up to this sequence have been received
  Step resend_after_steps = 120;        ///< an unacknowledged hand-off is sent again every so often
  std::vector<TogetherPair> together;   ///< a < b, ascending
  std::vector<Listened> related;        ///< regions, besides those near us, that listen from the start
  bool listening_ends = true;           ///< false: regions that have been introduced listen to each other for ever
};

struct Changes {
  std::vector<Adoption> adoptions;  ///< in the order in which they join
  std::vector<BodyId> let_go;       ///< bodies of which another node has a higher epoch: take them out first
  std::vector<Order> orders;  ///< orders received since the last step, in sequence; execute them before anything else
  /// Introductions of the newest batches that take effect, this node's own included.
  std::vector<Introduction> introductions;
};

/// Clusters that have to leave for one region. The caller releases their bodies from physics and passes them to
/// hand_over().
struct Departure {
  RegionId destination{};
  HandOffReason reason{};
  std::vector<BodyId> bodies;  ///< ascending
};

/// Counts of bodies since the start.
struct ProtocolCounters {
  std::uint64_t handed_over = 0;
  std::uint64_t let_go = 0;
  /// arrivals refused, because the body is here already with the same or a higher epoch
  std::uint64_t stale_arrivals = 0;
};

/// State that outlives a redo: the next Protocol takes over with it.
struct Continuation {
  OrderLog orders;
  AlarmLog alarms;
  ViolationLog violations;
  ProtocolCounters counters;
  std::vector<RegionId> dead;
  std::vector<Listened> related;
};

class Protocol {
 public:
  /// `map` and `clearance` have to outlive the protocol.
  Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance);
  /// Begins after a redo, in the state of the cut.
  Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance,
           Continuation continuation);
  Protocol(const Protocol&) = delete;
  Protocol& operator=(const Protocol&) = delete;

  const Vicinity& vicinity() const { return vicinity_; }
  const Aura& aura() const { return *aura_; }

  /// Adds regions that listen to us and that we listen to. Call before the first state.
  void listen_to(std::span<const Listened> regions) { listening_.add(regions); }
  std::span<const Listened> listens_to() const { return listening_.all(); }

  /// Takes the messages out of `inbox`, at any time. Those of a later generation or redo stay there. Orders and alarms
  /// count from now on.
  void accept(Inbox& inbox);

  /// May state `n` be computed? In kFreeRunning always. Otherwise when every live neighbour's batch of stamp n - K has
  /// arrived, and its hand-offs up to that stamp.
  bool ready(Step n) const { return intake_.ready(n); }
  /// The live neighbours that keep state `n` waiting.
  std::vector<RegionId> missing(Step n) const { return intake_.missing(n); }

  /// Lets messages take effect. Returns what changes before state `n` is computed; valid until the next call.
  const Changes& receive(Step n, Joining joining = Joining::kInTime);

  /// Introduces regions with the batch of the last observe(). For coupled regions, whose bodies are not the protocol's
  /// concern.
  void introduce(std::vector<Introduction> pairs) { outbox_.aura.introductions = std::move(pairs); }

  /// Looks at a state. Returns who has to leave; valid until the next call.
  const std::vector<Departure>& observe(const Snapshot& snapshot);

  /// After a redo, in the state of the cut: true if gather() has not been called yet, and all neighbours have said
  /// their part of this state.
  bool may_gather() const { return gathers_ && intake_.knows_all_of_start(); }
  /// Looks at the state of the cut once more, now that the others' bodies of this state are known. The clusters that it
  /// returns take part in the next state at their new hosts. So a touch in the next state can still be prevented.
  /// outbox() is a word then, complete after the last hand_over().
  const std::vector<Departure>& gather(const Snapshot& snapshot);

  /// Numbers an order and publishes it with the next step. receive() returns it like orders of others. Only for the
  /// lead, which numbers all orders.
  const Order& announce(Order order) { return orders_.announce(std::move(order), outbox_.aura.stamp); }
  std::uint64_t last_order() const { return orders_.last(); }
  /// Orders that receive() has not returned yet.
  std::span<const Order> orders_to_come() const { return orders_.news(); }
  /// The earliest state in which an order announced now can take effect. Before it, all nodes have received the order
  /// and know of the body that it adds or the kick that it gives.
  Step earliest_effect() const;
  /// Like earliest_effect(), for orders that add or move no body: before that state all nodes have received the order.
  Step earliest_agreement() const;

  /// Call for each state that adopted clusters have made up together. `world`: a number that no other such world has,
  /// also not one that has joined in an earlier state or joins later.
  void note_made_up(Step step, std::uint32_t world, std::span<const BodyRecord> bodies);

  // While the run stands in the state of the last observe(), and all that others have sent up to it has arrived
  // (core/standing.h)
  /// Has begin_to_stand() been called in this state?
  bool stands() const { return standing_.state() == outbox_.aura.stamp; }
  void begin_to_stand();
  /// Call after begin_to_stand() for each state, up to the present one, of a cluster that joins later. `world` as in
  /// note_made_up().
  void note_to_come(Step step, std::uint32_t world, std::span<const BodyRecord> bodies);
  /// The next word to send; null: there is none now. Precondition: stands(). Call again until it returns null.
  const Outbox* next_word();
  /// The newest state in which the run stood and which all nodes have checked, as far as this node knows; -1: none.
  Step checked_by_all() const { return checked_by_all_; }

  /// The newest state that this node has checked. With AuraRules::redo only.
  Step checked() const { return check_.checked(); }
  /// The newest confirmed state: no alarm can question it any more, and every other node has as good as confirmed it
  /// (confirmed_here). With AuraRules::redo only.
  Step confirmed() const;
  /// The newest state about which this node would have heard of an alarm. At least confirmed() of all nodes by the time
  /// that they hear of an order given now.
  Step confirmed_here() const;
  /// Like confirmed(), but ignores the alarms that stand now.
  Step confirmed_but_for_alarms() const;
  const AlarmLog& alarms() const { return alarms_; }
  /// Call when a node has died: what it hosted cannot be computed again. Alarms then lead to no redo, but all nodes
  /// still execute a redo that has been ordered.
  void give_up_alarms() { alarms_given_up_ = true; }
  bool alarms_given_up() const { return alarms_given_up_; }
  /// Are states that the check finds wrong computed again?
  bool computes_again() const { return aura_->rules().redo && !alarms_given_up_; }
  /// Counts a setpoint message that arrived `late` states after its own state, when states are computed again that
  /// another node may have computed with it.
  void report_late_word(Step step, Step late) {
    violations_.add({ViolationKind::kLatency, step, vicinity_.self, {}, static_cast<double>(late), 0});
  }
  /// Raises an alarm: state `step` was computed with a static at the wrong place.
  void doubt(Step step) { alarms_.raise(step, kNobody, kNobodyElse); }
  /// Number of states that a message needs at most to reach every node. Where regions are coupled: an order.
  Step round() const { return hops_of_orders_ * aura_->rules().lookahead; }
  /// The state to pass to the next Protocol after the redo of this order.
  Continuation continuation(const Order& redo) const;

  /// Hands over the cluster of a departure, as released from physics. Call once for each departure, in order.
  void hand_over(const Departure& departure, ClusterState cluster);

  /// The messages that the step publishes. Complete after the last hand_over().
  const Outbox& outbox() const { return outbox_; }

  /// Reports that computing `step` took `frame_s` of wall-clock time. Longer than T_F counts as a violation.
  void report_frame(Step step, double frame_s);

  const Intake& intake() const { return intake_; }
  const InterestMatching& matching() const { return matching_; }
  const Projection& projection() const { return projection_; }
  /// The track of a body; null if it was not hosted here in the last state.
  const Track* find(BodyId id) const;
  const DepartureLedger& departures() const { return departures_; }
  const ProtocolCounters& counters() const { return counters_; }
  const ViolationLog& violations() const { return violations_; }
  /// Newest step in which this node broke a promise, or a neighbour reported that it broke one.
  Step last_violation_step() const { return last_violation_step_; }
  /// Number of bodies in the largest cluster near a boundary in the last state.
  std::size_t largest_cluster() const { return largest_cluster_; }

 private:
  Protocol(const ProtocolSettings& settings, const RegionMap& map, const ClearanceQuery& clearance,
           std::span<const std::vector<RegionId>> near);
  void take_if_newer(Adoption& adoption);
  void let_go_of_what_others_own();
  void let_go(BodyId id);
  void apply_late(Order& order, Step n);
  void look(const Snapshot& snapshot);
  void decide(const Snapshot& snapshot);
  void decide_for_clusters(const Snapshot& snapshot);
  void list_complete_clusters();
  void decide_for_cluster(std::uint32_t i, const Snapshot& snapshot);
  void send_home(const Snapshot& snapshot);
  void decide_naively(std::uint32_t i, const Snapshot& snapshot);
  bool settles_elsewhere(std::uint32_t i, Step now);
  RegionId lowest_owner(std::uint32_t i) const;
  void depart(std::uint32_t i, RegionId destination, HandOffReason reason, const Snapshot& snapshot);
  void fill_header();
  void sign(AuraBatch& batch) const;
  void receive_violations();
  void check(const Snapshot& snapshot);
  void check_as_it_stands();
  Step heard_of_all(Step patience) const;
  Step before_alarms(Step confirmed) const;
  void note_lonely(Step step, std::uint32_t world, std::span<const BodyRecord> bodies, std::vector<AuraRecord>& past);

  ProtocolSettings settings_;
  Vicinity vicinity_;
  std::uint64_t map_version_;
  std::unique_ptr<const Aura> aura_;
  DepartureLedger departures_;
  Intake intake_;
  InterestMatching matching_;
  Projection projection_;
  OrderLog orders_;
  int hops_of_orders_;
  Listening listening_;
  Introducer introducer_;
  bool alarms_given_up_ = false;
  bool gathers_;       ///< a redo has just begun, and this node has not gathered yet
  bool full_ = false;  ///< a region listens to us for the first time, so the batch has to be full
  AlarmLog alarms_;
  StateCheck check_;
  std::vector<AuraRecord> past_;  ///< AuraBatch::past of the next batch
  Standing standing_;
  Outbox word_;
  Step checked_by_all_ = -1;
  Changes changes_;
  std::vector<Departure> departing_;
  struct CompleteCluster {
    std::uint32_t first;    ///< index of its first body
    std::uint32_t cluster;  ///< its label
  };
  std::vector<CompleteCluster> complete_;
  std::vector<std::uint32_t> homing_;    ///< a body of each cluster that is to go home
  std::vector<std::uint8_t> goes_home_;  ///< by cluster; all 0 between two states
  Outbox outbox_;
  ProtocolCounters counters_;
  ViolationLog violations_;
  std::uint64_t violations_received_ = 0;
  Step last_violation_step_ = -1'000'000;
  std::size_t largest_cluster_ = 0;
};

/// The host of each body in state 0, the same on every node. Each cluster of the whole scene gets the lowest region
/// that owns the centre of one of its members. Returns one region per body of `scene`.
std::vector<RegionId> assign_hosts(const RegionMap& map, const AuraRules& rules, const ClearanceQuery& clearance,
                                   const Snapshot& scene);

}  // namespace aurasim::core
