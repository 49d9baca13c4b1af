// Chooses the states that a node sends to an observer that is slower than the run. Pure.
//
// A state is whole for the observer when all regions have sent it. Nodes do not agree on the states that they leave
// out. A node that finds an observer too slow halves the states that it sends, chosen by their numbers. So the states
// sent by the slowest node are sent by all others, too.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/ids.h"

namespace aurasim::process {

class ObserverPace {
 public:
  /// True if state `step` is to be sent to an observer that asked for multiples of `every`.
  bool is_for(core::Step step, std::uint32_t every) const { return step % (core::Step{every} * apart_) == 0; }
  void note_sent() {
    if (apart_ == 1 || ++in_a_row_ < kUntilMore) return;
    apart_ /= 2;
    in_a_row_ = 0;
  }
  void note_too_slow() {
    apart_ = std::min(2 * apart_, kFarthestApart);
    in_a_row_ = 0;
  }

 private:
  static constexpr core::Step kFarthestApart = 1024;
  static constexpr int kUntilMore = 32;  ///< after so many states taken, twice as many are sent

  core::Step apart_ = 1;
  int in_a_row_ = 0;
};

}  // namespace aurasim::process
