// Before a step, many coupled regions tell each other along a tree (core/seam_tree.h) which of them have to exchange
// parcels in it. A region that has heard that knows, too, that all others have ended the step before. Few regions know
// both from each other's batches.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/introduction.h"
#include "core/seam_mail.h"

namespace aurasim::node {

/// Returns what all of `regions` regions have said. `known`: what this node knows before, from its own batch and those
/// of the regions that it listens to. Throws core::SeamsBroken if a region is lost, or has posted what no region posts.
std::vector<core::Introduction> gather_pairs(core::SeamMail& mail, core::RegionId self, std::size_t regions,
                                             std::span<const core::Introduction> known);

}  // namespace aurasim::node
