// The touches that a step solves, in an order that follows from the bodies alone, however they were found.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/threads.h"
#include "physics/soft/touch.h"

namespace aurasim::physics {

class SoftIslands;

class SortedTouches {
 public:
  /// Takes the touches with a body that moves in the step, after SoftIslands::settle(). The order is that of the
  /// bodies' user indices, then of their parts.
  void sort(std::span<const SoftTouch> touches, const SoftIslands& islands, soft::Team& team);
  std::span<const SoftTouch> all() const { return sorted_; }

 private:
  void sort_many(std::size_t last, soft::Team& team);

  std::vector<SoftTouch> sorted_, unsorted_;
  std::vector<std::uint32_t> ends_;  ///< by user index: end of the body's touches
};

}  // namespace aurasim::physics
