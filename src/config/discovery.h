// How DDS participants find each other.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aurasim::config {

/// Above this number of nodes a start with a hub takes less time than one without (docs/decisions/0052).
inline constexpr std::size_t kMostNodesWithoutHub = 16;

enum class Discovery : std::uint8_t {
  kAuto,        ///< as kMulticast; `launch` gives a run of many nodes on one host a hub, as with kNeighbours
  kMulticast,   ///< as in the QoS profile; the shipped ones use multicast
  kPeers,       ///< no multicast: announcements go to the addresses of `peers`
  kServer,      ///< through the discovery servers in `peers`
  kNeighbours,  ///< no multicast: the run's hub introduces those that have something to say to each other
};

}  // namespace aurasim::config
