// How DDS participants find each other.
#pragma once

#include <cstdint>

namespace aurasim::config {

enum class Discovery : std::uint8_t {
  kMulticast,  ///< as the QoS profile says, and the shipped ones say so
  kPeers,      ///< no multicast: announcements go to the addresses of `peers`
  kServer,     ///< by the discovery servers in `peers`
};

}  // namespace aurasim::config
