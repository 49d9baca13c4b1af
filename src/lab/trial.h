// Runs one pair in one world, and on several nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "lab/metrics.h"
#include "lab/pair.h"
#include "lab/virtual_cluster.h"

namespace aurasim::lab {

/// Random settings of a trial's nodes, the same for every variant.
struct Disorder {
  std::vector<double> phase_s;  ///< by region, 0 to one frame (thesis section 5.2.3)
  std::uint64_t seed = 1;       ///< seed of frame times and losses
};

Disorder make_disorder(const Conditions& conditions, Chance& chance);

/// Rules of the nodes for a variant.
ClusterRules rules_of(const Conditions& conditions, const Variant& variant, const Disorder& disorder);

/// Last state of a trial. It is late enough that a late hand-off shows after the pair has passed each other.
core::Step last_step(const Pair& pair, const Conditions& conditions, const std::optional<Contact>& central);

Contact contact_of(const node::SeenCollision& seen);

/// One entry for each cluster that was handed over: state, source, destination, reason.
using HandOffs = std::set<std::tuple<core::Step, core::RegionId, core::RegionId, core::HandOffReason>>;

/// Counts the hand-offs before state `met` in `trial`.
void count_hand_offs(Trial& trial, HandOffs hand_offs, core::Step met);

/// Seconds until a lost datagram has been retransmitted. The reliable RTPS writer sends a heartbeat every period with
/// what it has, the reader asks for what it lacks, and the writer retransmits it. So one loss costs a heartbeat period
/// and a round trip, and another loss costs the same again. Later messages wait, because delivery is in order.
double resend_after_s(const Conditions& conditions);
inline constexpr double kHeartbeat_s = 0.005;  ///< of the aura and migration writers, qos/aurasim.xml

/// The first contact in one world.
std::optional<Contact> run_central(const Pair& pair, const Conditions& conditions);

/// Runs the pair under `variant`. Fills in the results, but not the fields that identify the trial.
Trial run_pair(const Pair& pair, const Conditions& conditions, const Variant& variant, const Disorder& disorder,
               const std::optional<Contact>& central);

}  // namespace aurasim::lab
