// How DDS participants find each other.
#pragma once

#include <cstdint>

namespace aurasim::config {

enum class Discovery : std::uint8_t {
  kMulticast,   ///< as in the QoS profile; the shipped ones use multicast
  kPeers,       ///< no multicast: announcements go to the addresses of `peers`
  kServer,      ///< through the discovery servers in `peers`
  kNeighbours,  ///< no multicast: the run's hub introduces those that have something to say to each other
};

}  // namespace aurasim::config
