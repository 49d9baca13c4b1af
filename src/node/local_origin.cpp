#include "node/local_origin.h"

#include <cmath>

#include <Eigen/Geometry>

namespace aurasim::node {
namespace {

using core::Vec3;

constexpr double kGrid_m = 16;

Eigen::AlignedBox3d contents(const core::Scene& scene, const core::RegionMap& map, core::RegionId region) {
  Eigen::AlignedBox3d box;
  const auto include = [&](const Vec3& p) {
    if (map.owner(p) == region) box.extend(p);
  };
  for (const core::InitialBody& body : scene.bodies) include(body.pose.p_WB);
  for (const core::Injector& injector : scene.injectors) {
    const Eigen::AlignedBox3d volume(injector.volume_min, injector.volume_max);
    for (int corner = 0; corner < 8; ++corner) {
      include(volume.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    }
  }
  return box;
}

double middle(double low, double high, double otherwise) {
  if (std::isfinite(low) && std::isfinite(high)) return low / 2 + high / 2;
  if (std::isfinite(otherwise)) return otherwise;
  if (std::isfinite(low)) return low;
  return std::isfinite(high) ? high : 0;
}

}  // namespace

Vec3 local_origin(const core::Scene& scene, const core::RegionMap& map, core::RegionId region) {
  const Eigen::AlignedBox3d inside = contents(scene, map, region);
  const Vec3 centre = inside.isEmpty() ? Vec3::Constant(std::nan("")) : Vec3(inside.center());
  const core::Rectangle& r = map.region(region);
  const Vec3 p_WO(middle(r.x0, r.x1, centre.x()), middle(r.y0, r.y1, centre.y()),
                  std::isfinite(centre.z()) ? centre.z() : 0);
  return (p_WO / kGrid_m).array().round() * kGrid_m;
}

}  // namespace aurasim::node
