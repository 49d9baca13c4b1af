// The one definition of thrashing, used wherever it is counted.
#pragma once

namespace aurasim::records {

/// True if two successive changes of host of one body are pulls in opposite directions with no contact between them
/// (thesis, section 3.7). `Move` is HandOffRow, or the report's copy of it.
template <class Move>
bool is_thrashing(const Move& before, const Move& now) {
  return before.is_pull() && now.is_pull() && !now.touched && now.destination == before.source &&
         now.source == before.destination;
}

}  // namespace aurasim::records
