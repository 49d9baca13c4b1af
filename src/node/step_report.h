// The report of a node on one step: rows for the records, and results for observers and clients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/order.h"
#include "core/redo.h"
#include "core/setpoint.h"
#include "core/violation.h"
#include "node/collision_watch.h"
#include "physics/region_world.h"

namespace aurasim::node {

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

/// A body's first host, and the state in which it exists first.
struct Birth {
  core::BodyId body{};
  core::Step birth = 0;
};

/// The bodies of a region when its run ends.
struct BodiesAtEnd {
  std::vector<core::BodyState> here;       ///< hosted in the last whole state
  std::vector<core::BodyState> under_way;  ///< between two hosts: the other one may have them, too
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
  double gathering_s = 0;  ///< waiting until all coupled regions have ended the state before
  double hash_s = 0;       ///< hashing the state. Hashes of states made up for late bodies count as physics
};

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
  std::vector<core::BodyRecord> departed;  ///< the bodies of `departures` as they left, in the states of their stamps
  std::vector<core::BodyId> let_go;        ///< bodies dropped here because another node hosts them under a higher epoch
  std::vector<HandOffRow> arrivals;
  std::vector<MadeUp> made_up;  ///< filled only while somebody observes
  std::vector<SeenCollision> collisions;
  std::vector<HashPart> hash;  ///< hash parts of this state, and of states made up for bodies that joined
  std::vector<core::Violation> violations;
  std::uint64_t violations_total = 0;            ///< since the start
  std::optional<core::Step> put_back_from;       ///< set after a redo: the run has gone back from this state to `step`
  core::Step put_back_confirmed = 0;             ///< states up to this one count as they were before the redo
  std::vector<core::TogetherPair> put_back_for;  ///< pairs of the redo; they now come to one host in time
  bool put_back_for_static = false;              ///< the redo was, also, for a static that was elsewhere than ordered
};

}  // namespace aurasim::node
