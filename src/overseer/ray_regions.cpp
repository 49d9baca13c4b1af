#include "overseer/ray_regions.h"

#include <algorithm>
#include <set>

namespace aurasim::overseer {
namespace {

/// Clips the segment to the slab low <= coordinate <= high.
bool clip(double from, double to, double low, double high, double& enter, double& leave) {
  const double along = to - from;
  if (along == 0) return low <= from && from <= high;
  const double a = (low - from) / along, b = (high - from) / along;
  enter = std::max(enter, std::min(a, b));
  leave = std::min(leave, std::max(a, b));
  return enter <= leave;
}

bool crosses(const Segment& ray, const core::Rectangle& region, double margin_m) {
  double enter = 0, leave = 1;
  return clip(ray.from.x(), ray.to.x(), region.x0 - margin_m, region.x1 + margin_m, enter, leave) &&
         clip(ray.from.y(), ray.to.y(), region.y0 - margin_m, region.y1 + margin_m, enter, leave);
}

/// Distance of a point from the segment, metres.
double distance_to(const Segment& segment, const core::Vec3& p) {
  const core::Vec3 along = segment.to - segment.from;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? std::clamp((p - segment.from).dot(along) / squared, 0.0, 1.0) : 0;
  return (segment.from + share * along - p).norm();
}

}  // namespace

std::vector<core::RegionId> regions_for_ray(const Segment& ray, const core::RegionMap& map, const WorldView& view,
                                            const core::Scene& scene, double margin_m) {
  std::set<core::RegionId> asked;
  for (std::uint32_t r = 0; r < map.size(); ++r) {
    if (crosses(ray, map.region(core::RegionId{r}), margin_m)) asked.insert(core::RegionId{r});
  }
  std::vector<double> radius_m;
  for (const core::Prototype& prototype : scene.prototypes) {
    radius_m.push_back(core::bounding_radius(scene.shapes[prototype.shape].shape));
  }
  view.for_each([&](const ViewBody& body) {
    const auto kind = core::value_of(body.prototype);
    const double reach_m = (kind < radius_m.size() ? radius_m[kind] : 0) + margin_m;
    if (distance_to(ray, body.p_WB) <= reach_m) asked.insert(body.host);
  });
  return {asked.begin(), asked.end()};
}

}  // namespace aurasim::overseer
