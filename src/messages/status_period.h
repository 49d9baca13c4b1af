// How often a node publishes its status. The same on all sides: who watches for statuses takes its time limits from
// here.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace aurasim::messages {

/// Time between two statuses of one node in a run with so many regions. Everybody receives the statuses of all nodes,
/// so the period grows with their number: nobody receives more than 100 statuses a second, up to 100 nodes. A status in
/// which something has changed that others wait for is published at once.
constexpr std::chrono::milliseconds status_period(std::size_t regions) {
  constexpr std::size_t kFewest = 10, kMost = 100, kOfANode_ms = 10;
  return std::chrono::milliseconds(kOfANode_ms * std::clamp(regions, kFewest, kMost));
}

}  // namespace aurasim::messages
