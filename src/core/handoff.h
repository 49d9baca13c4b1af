// Ledgers that make each hand-off take effect exactly once. (source, destination, sequence) identifies a hand-off; the
// epochs in it decide which copy of a body is the valid one.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <vector>

#include "core/messages.h"

namespace aurasim::core {

/// The sender's side: keeps every hand-off until its receiver says that it has adopted it.
class DepartureLedger {
 public:
  /// Numbers and keeps a hand-off; returns the kept copy.
  const HandOff& record(HandOff hand_off);

  /// Forgets the hand-offs to `destination` up to this number.
  void acknowledge(RegionId destination, std::uint64_t last_sequence);

  /// Appends copies of the hand-offs that are due to be sent again: open for a multiple of `patience` steps.
  void due_again(Step now, Step patience, std::vector<HandOff>& out) const;

  std::uint64_t last_sequence(RegionId destination) const;
  const std::deque<HandOff>& open() const { return open_; }

 private:
  std::map<RegionId, std::uint64_t> last_sequence_;
  std::deque<HandOff> open_;
};

/// The receiver's side: distinguishes first copies from later ones.
class ArrivalLedger {
 public:
  /// True for the first copy of a hand-off from `source`.
  bool first_copy(RegionId source, std::uint64_t sequence);

  /// Have all hand-offs from `source` numbered up to `sequence` arrived?
  bool has_all_up_to(RegionId source, std::uint64_t sequence) const;

  /// For each region from which hand-offs have arrived: the number up to which all have. Ascending.
  std::vector<HandOffMark> all_arrived() const;

 private:
  struct Stream {
    std::uint64_t contiguous = 0;
    std::set<std::uint64_t> ahead;
  };
  std::map<RegionId, Stream> streams_;
};

}  // namespace aurasim::core
