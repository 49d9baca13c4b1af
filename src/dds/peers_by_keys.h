#pragma once

#include <cstddef>

namespace aurasim::dds {

/// Numbers of other participants of the domain, of any run.
struct PeersByKeys {
  std::size_t with_keys = 0;
  std::size_t without_keys = 0;
  std::size_t refused = 0;  ///< those with keys that this process, which has keys itself, does not accept
};

}  // namespace aurasim::dds
