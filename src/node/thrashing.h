// Thrashing, as everybody counts it.
#pragma once

namespace aurasim::node {

/// Two changes of host of one body, one after the other: pulls in opposite directions with no contact between them
/// (thesis, section 3.7). Of HandOffRow, or of what a report has of it.
template <class Move>
bool is_thrashing(const Move& before, const Move& now) {
  return before.is_pull() && now.is_pull() && !now.touched && now.destination == before.source &&
         now.source == before.destination;
}

}  // namespace aurasim::node
