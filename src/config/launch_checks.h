// What must hold between the parts of a launch file.
#pragma once

#include <optional>

#include "config/fields.h"
#include "config/launch.h"

namespace aurasim::config {

/// Largest K, given or from the tolerances.
inline constexpr int kLargestLookahead = 64;

/// Distance between the surfaces of two bodies within which they have to share a host, at the top speed of the
/// tolerances, plus the largest bounding radius of each (docs/design.md, "The aura and
/// its reach"). Metres.
double reach_m(const Launch& launch);

/// Farthest from a region at which another one may have to hear of its bodies. Metres.
double zone_m(const Launch& launch);

/// Regions wide enough for their auras, K and the number of neighbours in bounds; sets neighbour_distance_m.
void check_regions(const Field& regions, std::optional<double> neighbour_distance_m, Launch& launch);

/// Statics that move need a solver that knows them.
void check_statics(const Field& physics, const Launch& launch);

/// `ros2`, once scene and DDS have been read.
void read_ros2(const Field& ros2, Launch& launch);

}  // namespace aurasim::config
