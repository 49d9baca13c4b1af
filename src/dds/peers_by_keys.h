#pragma once

#include <cstddef>

namespace aurasim::dds {

/// Numbers of other participants of the domain, of whatever run.
struct PeersByKeys {
  std::size_t with_keys = 0;
  std::size_t without_keys = 0;
  std::size_t refused = 0;  ///< of those with keys: this process has keys, and does not believe theirs
};

}  // namespace aurasim::dds
