// The receiving half of the protocol. It sorts messages, decides when the next state may be computed and which bodies
// join before it, and marks neighbours dead.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/handoff.h"
#include "core/messages.h"
#include "core/neighbour.h"
#include "core/sync_mode.h"
#include "core/vicinity.h"
#include "core/violation.h"

namespace aurasim::core {

struct IntakeSettings {
  Generation generation = 0;
  std::uint32_t redo = 0;
  SyncMode sync = SyncMode::kBounded;
  int lookahead = 1;
  Step start = 0;  ///< the first state that any node publishes
  /// True: batches of `start` take effect in the next state instead of K later, and the nodes gather in `start`.
  bool knows_start = false;
};

/// A cluster that joins this node, as it was in state `stamp`.
struct Adoption {
  RegionId source{};
  Step stamp = 0;
  std::uint64_t sequence = 0;
  HandOffReason reason{};
  ClusterState cluster;
};

/// Counts since the start.
struct IntakeCounters {
  std::uint64_t adopted = 0;    ///< bodies
  std::uint64_t copies = 0;     ///< duplicate messages
  std::uint64_t strangers = 0;  ///< messages of non-neighbours: unknown, dead or differently configured senders
};

/// Which of the clusters that have arrived join.
enum class Joining {
  kInTime,  ///< those handed over in a state that may take effect by now
  kAll      ///< all. For after the last state: in free-running mode a neighbour may end in a later one
};

class Intake {
 public:
  Intake(const IntakeSettings& settings, const Vicinity& vicinity, DepartureLedger& departures);

  /// Takes the messages out of `inbox`. Those for a later generation or redo stay there.
  void accept(Inbox& inbox);
  /// From now on calls `arrived(neighbour)` for each batch that arrives, in order of stamp. For the check, which does
  /// not wait until batches take effect.
  void on_arrival(Neighbour::Arrived arrived) { arrived_ = std::move(arrived); }

  bool ready(Step n) const;
  std::vector<RegionId> missing(Step n) const;
  /// Has everything arrived that all live neighbours had to say of the state `start`, before they gather?
  bool knows_all_of_start() const;
  /// Lets what the neighbours have said of the state `start` take effect, in that state.
  void take_start();

  /// Lets messages take effect before state `n` is computed. Returns the clusters that join, in the order in which they
  /// join.
  std::vector<Adoption> receive(Step n, ViolationLog& violations, Joining joining = Joining::kInTime);
  /// Has everything arrived that the neighbour has sent up to state `until`? True for a region that is no live
  /// neighbour.
  bool has_all(RegionId region, Step until) const;

  /// Have all live neighbours that publish state `stamp` said this word in it?
  bool all_have_said(Step stamp, std::uint32_t number) const;

  std::span<const Neighbour> neighbours() const { return neighbours_; }
  /// Neighbours marked dead. They are not waited for, and nothing of them is accepted any more.
  std::vector<RegionId> dead_regions() const;
  /// Refused messages of live neighbours. Each of these neighbours has been marked dead for it.
  const std::vector<Refusal>& refusals() const { return refusals_; }
  /// Hand-offs that have arrived and do not take effect yet.
  std::span<const HandOff> to_come() const { return waiting_; }
  const IntakeCounters& counters() const { return counters_; }

  /// Orders that have arrived since the last call, by neighbour, each neighbour's in sequence. Also those in `inbox`,
  /// from nodes that a redo has already put back; these are returned again until this node is put back, too.
  std::vector<Order> take_orders(const Inbox& inbox);
  /// Alarms that have arrived since the last call, by neighbour.
  std::vector<Alarm> take_alarms();
  std::vector<Neighbour::Introduced> take_introductions();
  /// Makes `region` a neighbour, which publishes from its state `begin` on.
  void listen_to(RegionId region, Step begin);
  /// Region `region` is no neighbour any more: it publishes nothing from its state `end` on. What it has published
  /// before still takes effect, but for its auras.
  void leave(RegionId region, Step end);
  /// Regions that have left, and from which nothing is to come any more, since the last call.
  std::vector<RegionId> take_left() { return std::exchange(left_, {}); }
  /// False for a neighbour that is marked dead.
  bool is_alive(RegionId region) const;

  /// The hand-offs that have been adopted, for the next batch.
  std::vector<HandOffMark> adopted() const;

 private:
  /// A former neighbour of which not everything has taken effect.
  struct Leaver {
    Neighbour neighbour;
    Step end;  ///< the first state that it does not publish
  };
  Neighbour* find(RegionId id);
  const Neighbour* find(RegionId id) const;
  Neighbour* speaker(RegionId id, Step stamp);
  void forget_leavers();
  bool keeps_waiting(const Neighbour& neighbour, Step n) const;
  bool keeps_waiting(const Leaver& leaver, Step n) const;
  bool has_all(const Neighbour& neighbour, Step until) const;
  template <class Message>
  bool belongs(const Message& message, std::uint64_t map_version);
  template <class Message>
  bool is_early(const Message& message);
  void forget_early(Step before);
  void accept(HandOff& hand_off);
  void note_adopted(const AuraBatch& batch);
  void accept(const Refusal& refusal);
  void accept(const PeerEvent& event);
  void mark_dead(Neighbour& neighbour);
  void adopt_due(Step limit, Step n, ViolationLog& violations);
  void adopt(HandOff& hand_off);
  Step needed_for(Step n) const;
  Step effect_limit(Step n) const;

  IntakeSettings settings_;
  const Vicinity& vicinity_;
  std::uint64_t map_version_;
  std::vector<Neighbour> neighbours_;
  std::vector<Leaver> leavers_;
  std::vector<RegionId> left_;
  Neighbour::Arrived arrived_;
  Inbox early_;  ///< messages of regions that we do not listen to yet
  DepartureLedger& departures_;
  ArrivalLedger arrivals_;
  std::vector<HandOff> waiting_;  ///< received, not yet in effect
  std::vector<Adoption> adoptions_;
  std::vector<Refusal> refusals_;
  IntakeCounters counters_;
};

}  // namespace aurasim::core
