// Which states a node tells an observer that takes fewer than are computed. Pure.
//
// A state is whole when all regions have told it. Nodes do not talk about what they leave out: each of them that finds
// an observer too slow tells it every second state of those that it told before, by their numbers. So all nodes tell
// what the one tells that leaves out most.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/ids.h"

namespace aurasim::cli {

class ObserverPace {
 public:
  /// Is a state that is a multiple of `every` one of those that are told?
  bool is_for(core::Step step, std::uint32_t every) const { return step % (core::Step{every} * apart_) == 0; }
  void note_told() {
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
  static constexpr int kUntilMore = 32;  ///< states that it has taken after which it is told twice as many

  core::Step apart_ = 1;
  int in_a_row_ = 0;
};

}  // namespace aurasim::cli
