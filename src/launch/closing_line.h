// Outcome of a run in one line, from the nodes' statuses, for runs without records.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "dds/control.h"

namespace aurasim::launch {

/// The line with its end. `statuses`: the last status of each region. Regions whose nodes have not come to the end of
/// the run are named, because the fate of their bodies is unknown.
std::string closing_line(const std::map<core::RegionId, messages::SeenStatus>& statuses, std::size_t regions,
                         bool has_begun, double step_s);

/// "; broken promises: frame 3, speed 1", or empty if there are none. `by_kind`: docs/glossary.md.
std::string words_of_broken_promises(const std::map<std::string, std::uint64_t>& by_kind);

}  // namespace aurasim::launch
