#pragma once

#include <cstdint>

namespace aurasim::node {

/// The clock that measures the durations of a step.
enum class PhaseClock : std::uint8_t {
  kWall,       ///< wall-clock time
  kThreadCpu,  ///< CPU time of the node's thread, independent of how busy the machine is
};

}  // namespace aurasim::node
