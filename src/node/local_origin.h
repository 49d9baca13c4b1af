// Where a region's Bullet coordinates begin when they do not begin at the world's origin (physics.origin: region).
#pragma once

#include "core/region_map.h"
#include "core/scene.h"

namespace aurasim::node {

/// In the world frame, metres: the middle of the region, or, along an axis in which it reaches to infinity, the middle
/// of what the scene puts into it (bodies of state 0 and corners of injectors' volumes), or else its finite side.
/// A multiple of 16 m, so that coordinates convert exactly.
core::Vec3 local_origin(const core::Scene& scene, const core::RegionMap& map, core::RegionId region);

}  // namespace aurasim::node
