#include "core/block.h"

#include <algorithm>
#include <cmath>

#include "core/mechanisms.h"
#include "core/scene.h"

namespace aurasim::core {
namespace {

/// Index of the column that holds x. Places beyond any world count as the outermost column.
std::int32_t column_at(double x, double side_m) {
  constexpr double kMost = 1e9;
  const double column = std::floor(x / side_m);
  return std::isfinite(column) ? static_cast<std::int32_t>(std::clamp(column, -kMost, kMost)) : 0;
}

double outside_m(double x, std::int32_t column, double side_m) {
  const double low = static_cast<double>(column) * side_m;
  return std::max({low - x, x - (low + side_m), 0.0});
}

/// How far bodies reach from the centre of the first body of their mechanism, m, and how many bodies do.
struct Reach {
  double reach_m, bodies;
};

double radius_m(const Scene& scene, PrototypeId prototype) {
  return bounding_radius(scene.shapes.at(scene.prototypes.at(value_of(prototype)).shape).shape);
}

/// The reaches of the bodies of the start come first, one for each.
std::vector<Reach> reaches_of(const Scene& scene) {
  std::vector<Reach> reaches;
  for (const InitialBody& body : scene.bodies) reaches.push_back({radius_m(scene, body.prototype), 1});
  std::vector<JointId> joints;
  for (std::uint32_t i = 0; i < scene.joints.size(); ++i) joints.push_back(JointId{i});
  for (const BoundBody& bound : mechanisms_of(scene.joints, joints)) {
    const InitialBody *const body = find_body(scene, bound.body), *const first = find_body(scene, bound.first);
    if (body == nullptr || first == nullptr) continue;
    const Vec3 apart = body->pose.p_WB - first->pose.p_WB;
    reaches[static_cast<std::size_t>(body - scene.bodies.data())].reach_m +=
        std::max(std::abs(apart.x()), std::abs(apart.y()));
  }
  for (const Injector& injector : scene.injectors) {
    const auto kinds = static_cast<double>(std::max<std::size_t>(1, injector.prototypes.size()));
    const double each = static_cast<double>(injector.max_bodies) / kinds;
    for (const PrototypeId prototype : injector.prototypes) reaches.push_back({radius_m(scene, prototype), each});
  }
  return reaches;
}

}  // namespace

Block block_at(const Vec3& p_W, double side_m) { return {column_at(p_W.x(), side_m), column_at(p_W.y(), side_m)}; }

double outside_m(const Vec3& p_W, const Block& block, double side_m) {
  return std::max(outside_m(p_W.x(), block.x, side_m), outside_m(p_W.y(), block.y, side_m));
}

bool blocks_are_near(const std::vector<BodyRecord>& bodies, double side_m) {
  const auto is_near = [side_m](const BodyRecord& body) {
    return !body.block.is_known() || outside_m(body.p_WB, body.block, side_m) <= side_m;
  };
  if (std::ranges::all_of(bodies, is_near)) return true;
  std::vector<Block> near;
  for (const BodyRecord& body : bodies) {
    if (is_near(body)) near.push_back(body.block);
  }
  std::ranges::sort(near);
  return std::ranges::all_of(
      bodies, [&](const BodyRecord& body) { return is_near(body) || std::ranges::binary_search(near, body.block); });
}

double usual_block_m(const Scene& scene) {
  constexpr double kMostGiants = 0.01;  ///< share of the bodies
  const std::vector<Reach> reaches = reaches_of(scene);
  double all = 0;
  for (const Reach& reach : reaches) all += reach.bodies;
  const auto giants_at = [&](double side_m) {
    double giants = 0;
    for (const Reach& reach : reaches) giants += reach.reach_m > kBlockRadius * side_m ? reach.bodies : 0;
    return giants;
  };
  double side_m = kUsualBlock_m;
  while (giants_at(side_m) > kMostGiants * all && side_m < kLargestBlock_m / 2) side_m *= 2;
  return side_m;
}

}  // namespace aurasim::core
