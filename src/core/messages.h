// The messages between nodes (docs/design.md, "On the wire"). Plain values: the transport decides how they travel.
// Every message carries the step it describes (its stamp) and the generation of the run.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/audience.h"
#include "core/body_state.h"
#include "core/ids.h"
#include "core/introduction.h"
#include "core/order.h"
#include "core/redo.h"

namespace aurasim::core {

/// State of the body of an aura, as bits.
enum AuraFlags : std::uint8_t {
  /// the body does not move until the next update, so its state is as fresh as its source's last batch
  kAuraAsleep = 1,
  kAuraGhost = 2,  ///< handed over to `host` at the aura's stamp; the source publishes it until the new host can
  kAuraAll = 3,
};

/// The aura of one body: where it is, how it moves, how fast it may become.
struct AuraRecord {
  BodyId id{};
  Epoch epoch = 0;
  RegionId host{};
  PrototypeId prototype{};
  std::uint8_t flags = 0;
  Step stamp = 0;  ///< the state this describes; equals the batch's stamp except for ghosts
  Step birth = 0;  ///< later than stamp: the body appears in that state; otherwise any earlier number
  Pose pose;
  Vec3 v_WB = Vec3::Zero();  ///< v_WB and w_WB are used by AuraKind::kSwept, and with a redo
  Vec3 w_WB = Vec3::Zero();
  double speed_m_s = 0;  ///< top speed that it may come to have (core/aura.h)
  /// The listeners for which this is. The others forget what they knew of the body.
  Audience audience = kAllListeners;
};

/// Number of a hand-off between the source of a batch and `region`. All earlier ones count, too.
struct HandOffMark {
  RegionId region{};
  std::uint64_t last_sequence = 0;
};

/// AuraBatch::word of the batch that says that a node has gathered (Protocol::gather).
inline constexpr std::uint32_t kGathered = 0xFFFF'FFFF;

/// One per node and step, even when nothing changed: it also means "this step is done". While the run stands, a node
/// publishes more of the same stamp, its words (core/standing.h), and one more in the state in which a redo begins.
struct AuraBatch {
  RegionId source{};
  Generation generation = 0;
  std::uint32_t redo = 0;  ///< how often this generation has been put back by a redo
  Step stamp = 0;
  std::uint32_t word = 0;  ///< 0: the batch of a step; else the number of a word, which has only `past`, or `hand_offs`
  std::uint64_t map_version = 0;
  bool full = false;  ///< `updates` is the whole set: the receiver forgets what it knew of this source
  double top_speed_m_s = 0;
  double top_radius_m = 0;
  /// ViolationLog::warnings() of the source: grows with every broken promise, and in every step in which one stays
  /// broken.
  std::uint64_t violations = 0;
  std::vector<AuraRecord> updates;
  std::vector<BodyId> deletes;
  std::vector<HandOffMark> hand_offs;       ///< sent by the source up to this state, where the last is of this state
  std::vector<HandOffMark> adopted;         ///< sent to the source, and adopted up to this state
  std::vector<Order> orders;                ///< orders that the source received since its last batch, in sequence
  std::vector<Alarm> alarms;                ///< alarms that the source raised or received since its last batch
  std::vector<Introduction> introductions;  ///< regions that are to listen to each other, as of this state
  /// Bodies in states before the stamp, which the source made up after they joined late. Used by the check of those
  /// states.
  std::vector<AuraRecord> past;
};

enum class HandOffReason : std::uint8_t {
  kAuraCollision = 0,      ///< AC
  kBoundaryTraversal = 1,  ///< BT
};

/// One cluster on its way to a new host. `sequence` counts from 1 for each (source, destination).
struct HandOff {
  RegionId source{};
  RegionId destination{};
  Generation generation = 0;
  std::uint32_t redo = 0;
  Step stamp = 0;
  std::uint64_t map_version = 0;
  std::uint64_t sequence = 0;
  HandOffReason reason = HandOffReason::kAuraCollision;
  ClusterState cluster;  ///< each body's epoch is already the new one
};

enum class PeerChange : std::uint8_t { kLost, kJoined };

/// Report of the transport that a neighbour's liveliness ended or began (again).
struct PeerEvent {
  RegionId region{};
  PeerChange change = PeerChange::kLost;
};

enum class MessageKind : std::uint8_t { kAura, kHandOff };
const char* name_of(MessageKind kind);

/// A message of this run and this map that the transport has refused because of its content. Sent again, it would be
/// the same.
struct Refusal {
  RegionId source{};
  Generation generation = 0;
  Step stamp = 0;
  MessageKind kind = MessageKind::kAura;
  std::string_view why;  ///< the reason; points to a string with static lifetime
  std::uint32_t redo = 0;
};

/// Messages that a transport delivered since the last Transport::take(), in order of arrival.
struct Inbox {
  std::vector<AuraBatch> auras;
  std::vector<HandOff> hand_offs;
  std::vector<Refusal> refusals;
  std::vector<PeerEvent> peers;

  void clear();
};

/// The messages that one step of one node publishes. The aura batch goes to every neighbour, the rest to its
/// destination.
struct Outbox {
  std::vector<RegionId> listeners;  ///< regions to which the batch goes, ascending
  std::vector<RegionId> expected;   ///< regions that will soon be listeners
  std::vector<RegionId> left;       ///< regions that were listeners, and from which nothing is to come any more
  AuraBatch aura;
  std::vector<HandOff> hand_offs;

  void clear();
};

}  // namespace aurasim::core
