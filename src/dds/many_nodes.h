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

/// Shortest heartbeat period of a writer; 0: the profile decides. Only for topics that all nodes read: while one reader
/// has not answered, each heartbeat asks all of them, and each answers. The newest status or map replaces all earlier
/// ones, so these can wait. What a step waits for is asked for as the profile says.
inline std::chrono::nanoseconds shortest_heartbeat(topics::TopicId topic, std::size_t nodes) {
  if (nodes < kManyNodes) return std::chrono::nanoseconds(0);
  const bool is_replaced = topic == topics::TopicId::kNodeStatus || topic == topics::TopicId::kRegionMap;
  if (is_replaced) return messages::status_period(nodes);
  const bool is_of_all = topics::at(topic).division == topics::Division::kNone;
  return std::chrono::milliseconds(is_of_all ? 100 : 0);
}

}  // namespace aurasim::dds
