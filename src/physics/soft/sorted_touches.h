// The touches that a step solves, in an order that follows from the bodies alone, however they were found.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

namespace aurasim::physics {

class SortedTouches {
 public:
  /// Takes the touches that act on a body that moves in the step: moves(slot). The order is that of the bodies' user
  /// indices, then of their parts.
  template <class Moves>
  void sort(std::span<const SoftTouch> touches, Moves&& moves, soft::Team& team) {
    sorted_.clear();
    std::ranges::copy_if(touches, std::back_inserter(sorted_), [&moves](const SoftTouch& touch) {
      return touch.acts && (moves(touch.slot_a) || moves(touch.slot_b));
    });
    sort(team);
  }
  std::span<const SoftTouch> all() const { return sorted_; }

 private:
  void sort(soft::Team& team);
  void sort_many(std::size_t last, soft::Team& team);

  std::vector<SoftTouch> sorted_, unsorted_;
  std::vector<std::uint32_t> ends_;  ///< by user index: end of the body's touches
};

}  // namespace aurasim::physics
