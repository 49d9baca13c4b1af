// Content of a message on topic seam.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace aurasim::messages {

struct SeamHeader {
  core::RegionId source{};
  core::RegionId destination{};
  core::Generation generation = 0;
  core::Step step = 0;       ///< the state that is being computed
  std::uint32_t number = 0;  ///< of the parcels from source to destination in this step, from 1
};

struct SeamParcel {
  SeamHeader header;
  std::vector<std::byte> octets;  ///< read in physics/
};

}  // namespace aurasim::messages
