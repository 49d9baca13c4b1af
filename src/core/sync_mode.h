// Whether and how nodes wait for each other.
#pragma once

#include <cstdint>

namespace aurasim::core {

enum class SyncMode : std::uint8_t {
  kFreeRunning,    ///< nodes never wait
  kBounded,        ///< nodes wait so that neighbours are at most K steps apart
  kDeterministic,  ///< kBounded, and messages take effect at fixed states
};

}  // namespace aurasim::core
