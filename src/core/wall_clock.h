// The wall clock, which hosts have in common as far as theirs agree.
#pragma once

#include <chrono>
#include <cstdint>

namespace aurasim::core {

/// Nanoseconds since 1970.
inline std::int64_t wall_clock_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace aurasim::core
