// What became of a run, in a line: by what its nodes have said of themselves, where nothing is recorded.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "dds/control.h"

namespace aurasim::cli {

/// With its end of line. `statuses`: the last ones. Regions whose nodes have not come to the end of the run are named,
/// since it is not known what became of their bodies.
std::string closing_line(const std::map<core::RegionId, dds::SeenStatus>& statuses, std::size_t regions, bool has_begun,
                         double step_s);

}  // namespace aurasim::cli
