// Sets of regions to which an aura goes, as bits: region r has bit r modulo 64. In a run with more than 64 regions some
// share a bit, so an aura may go to a region too many, and never to one too few.
#pragma once

#include <cstdint>

#include "core/ids.h"

namespace aurasim::core {

using Audience = std::uint64_t;
inline constexpr Audience kNobodyListens = 0;
inline constexpr Audience kAllListeners = ~Audience{0};

constexpr Audience audience_of(RegionId region) { return Audience{1} << (value_of(region) % 64); }

}  // namespace aurasim::core
