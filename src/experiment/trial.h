// One pair, once in one world and once in several.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/metrics.h"
#include "experiment/pair.h"

namespace aurasim::experiment {

/// What the nodes of a trial have of their own, the same for every variant.
struct Disorder {
  std::vector<double> phase_s;  ///< by region, 0 to one frame (thesis section 5.2.3)
  std::uint64_t seed = 1;       ///< of frames and losses
};

Disorder make_disorder(const Conditions& conditions, Chance& chance);

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

}  // namespace aurasim::experiment
