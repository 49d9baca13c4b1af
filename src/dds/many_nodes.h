// Periods that are longer where a run has many nodes. Everybody discovers everybody, so what each node says to all
// others grows with the square of their number; runs of few nodes are not changed (docs/decisions/0045).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "messages/status_period.h"
#include "topics/topics.h"

namespace aurasim::dds {

inline constexpr std::size_t kManyNodes = 10;

/// Shortest time between two announcements of a participant to one peer; 0: no limit.
constexpr std::chrono::nanoseconds shortest_between_announcements(std::size_t nodes) {
  return nodes < kManyNodes ? std::chrono::milliseconds(0) : messages::status_period(nodes);
}

/// Shortest time between two announcements of a participant while nothing happens; 0: the profile decides. It never
/// takes a larger part of the lease than a quarter.
constexpr std::chrono::nanoseconds shortest_announcement_period(std::size_t nodes) {
  return 4 * shortest_between_announcements(nodes);
}

/// Shortest heartbeat period of a writer, and shortest time before a reader that was matched first asks for what there
/// is; 0: the profile decides. While one reader has not answered, each heartbeat asks all of them, and each answers;
/// and a reader asks until its writer has matched it, and is answered each time. The newest status or map replaces all
/// earlier ones, so these can wait. Most heartbeats of auras are left out (rtps/heartbeat_limit.h), but each wakes a
/// thread. What else a step waits for is asked for as the profile says.
inline std::chrono::nanoseconds shortest_heartbeat(topics::TopicId topic, std::size_t nodes) {
  if (nodes < kManyNodes) return std::chrono::nanoseconds(0);
  if (topic == topics::TopicId::kAura) return std::chrono::milliseconds(20);
  if (topic == topics::TopicId::kNodeStatus) return 4 * messages::status_period(nodes);  // each status asks, too
  if (topic == topics::TopicId::kRegionMap) return messages::status_period(nodes);
  const bool is_of_all = topics::at(topic).division == topics::Division::kNone;
  return std::chrono::milliseconds(is_of_all ? 100 : 0);
}

/// True if writers prove their life less often, samples count as proofs, and readers wait longer for one: a proof is a
/// message to all readers. Only where another party watches the nodes: none of them is held for dead because of its
/// silence alone.
constexpr bool is_renewed_sparsely(std::size_t nodes, bool believes_silence) {
  return nodes >= kManyNodes && !believes_silence;
}

/// Lease of readers then. With short ones leases run out while many nodes share few cores. Fast DDS 2.9.1 then goes
/// over its readers without a lock (WLP::sub_liveliness_changed), and ends the process if one is being created.
inline constexpr std::chrono::seconds kSparseLease{10};

}  // namespace aurasim::dds
