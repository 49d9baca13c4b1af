// Finds the regions that have to be asked what a ray hits.
#pragma once

#include <vector>

#include "core/region_map.h"
#include "core/scene.h"
#include "overseer/world_view.h"

namespace aurasim::overseer {

/// A piece of a straight line, world frame, metres.
struct Segment {
  core::Vec3 from = core::Vec3::Zero();
  core::Vec3 to = core::Vec3::Zero();
};

/// Returns, ascending, the regions that the segment crosses or passes within `margin_m`, and the hosts of bodies that
/// it may hit, wherever they are. `margin_m`: how far a body may have moved since the view was updated.
std::vector<core::RegionId> regions_for_ray(const Segment& ray, const core::RegionMap& map, const WorldView& view,
                                            const core::Scene& scene, double margin_m);

}  // namespace aurasim::overseer
