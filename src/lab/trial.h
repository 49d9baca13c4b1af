// One pair, once in one world and once in several.
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

/// What the nodes of a trial have of their own, the same for every variant.
struct Disorder {
  std::vector<double> phase_s;  ///< by region, 0 to one frame (thesis section 5.2.3)
  std::uint64_t seed = 1;       ///< of frames and losses
};

Disorder make_disorder(const Conditions& conditions, Chance& chance);

/// How nodes are to compute a variant.
ClusterRules rules_of(const Conditions& conditions, const Variant& variant, const Disorder& disorder);

/// Up to which a trial goes: so much that a late hand-off can still be seen after the pair has passed each other.
core::Step last_step(const Pair& pair, const Conditions& conditions, const std::optional<Contact>& central);

Contact contact_of(const node::SeenCollision& seen);

/// One for each cluster that left: when, from where, to where, why.
using HandOffs = std::set<std::tuple<core::Step, core::RegionId, core::RegionId, core::HandOffReason>>;

/// Those before state `met` count.
void count_hand_offs(Trial& trial, HandOffs hand_offs, core::Step met);

/// Lost datagrams are sent again by the reliable writer (RTPS): it says every heartbeat period what it has, the reader
/// asks for what it lacks, the writer repeats it. So one loss costs a heartbeat period and a round trip, and whatever
/// is lost again costs the same again; later messages wait, since delivery is in order.
double resend_after_s(const Conditions& conditions);
inline constexpr double kHeartbeat_s = 0.005;  ///< of the aura and migration writers, qos/aurasim.xml

/// The first contact in one world.
std::optional<Contact> run_central(const Pair& pair, const Conditions& conditions);

/// The pair under `variant`: fills in what is found out, not which trial it is.
Trial run_pair(const Pair& pair, const Conditions& conditions, const Variant& variant, const Disorder& disorder,
               const std::optional<Contact>& central);

}  // namespace aurasim::lab
