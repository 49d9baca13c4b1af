// Chooses the nodes that keep the parts of a region, so that its world survives the death of its node and of one
// keeper, and a network that falls into halves. Uses no clock and no DDS.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/ids.h"

namespace aurasim::process {

/// The keepers of `region`: two regions, or one if the run has only two. The first is the next region on another host.
/// The second is about half the ring of regions away, because neighbours often share a switch; it is on a third host if
/// there is one. Regions without a known host are taken last. If all share one host, only the places on the ring count.
std::vector<core::RegionId> keepers_of(core::RegionId region, std::uint32_t regions,
                                       const std::map<core::RegionId, std::uint16_t>& hosts);

}  // namespace aurasim::process
