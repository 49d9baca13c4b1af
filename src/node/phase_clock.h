#pragma once

#include <cstdint>

namespace aurasim::node {

/// What the durations of a step count.
enum class PhaseClock : std::uint8_t {
  kWall,       ///< what a frame takes
  kThreadCpu,  ///< what the node's thread does, however busy the machine is
};

}  // namespace aurasim::node
