// Which nodes keep the parts of a region, so that its world survives the death of its node and of one keeper, and a
// network that falls into halves. No clock, no DDS.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/ids.h"

namespace aurasim::cli {

/// Two regions, or one where the run has only two. The first is the next region on another host. The second is about
/// half the ring of regions away, on a third host where there is one: neighbours often share a switch. Regions without
/// a known host are taken last, and where all share one host only the places on the ring count.
std::vector<core::RegionId> keepers_of(core::RegionId region, std::uint32_t regions,
                                       const std::map<core::RegionId, std::uint16_t>& hosts);

}  // namespace aurasim::cli
