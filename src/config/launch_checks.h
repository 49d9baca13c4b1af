// Checks conditions between the parts of a launch file.
#pragma once

#include <optional>
#include <string>

#include "config/fields.h"
#include "config/launch.h"

namespace aurasim::config {

/// Largest K, given or derived from the tolerances.
inline constexpr int kLargestLookahead = 64;

/// Distance between the surfaces of two bodies within which they have to share a host, at the top speed of the
/// tolerances, plus the largest bounding radius of each (docs/design.md, "The aura and
/// its reach"). Metres.
double reach_m(const Launch& launch);

/// Largest distance from a region at which another region's node may need its auras. Metres.
double zone_m(const Launch& launch);

/// True if all addresses that may carry traffic are of loopback, so that a hub can be there.
bool is_on_loopback(const Dds& dds);

/// Why the regions of this launch cannot be coupled; empty: they can be.
std::string why_not_coupled(const Launch& launch);

/// Checks that regions are wide enough for their auras or blocks, and that K and the number of neighbours are in
/// bounds. Sets neighbour_distance_m, and `exchange` where `auto` can mean only one.
void check_regions(const Field& regions, std::optional<double> neighbour_distance_m, Launch& launch);

/// Checks that the solver supports moving statics if there are any.
void check_statics(const Field& physics, const Launch& launch);

/// Reads `ros2`. Call it once the scene and `dds` have been read.
void read_ros2(const Field& ros2, Launch& launch);

}  // namespace aurasim::config
