// Ids that only have to differ between processes and requests.
#pragma once

#include <cstdint>
#include <random>

namespace aurasim::dds {

/// Never 0.
inline std::uint64_t draw_id() {
  std::random_device device;  // not physics: no seed
  std::uint64_t id = 0;
  while (id == 0) id = (std::uint64_t{device()} << 32U) | device();
  return id;
}

}  // namespace aurasim::dds
