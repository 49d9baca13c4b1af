#include "core/vicinity.h"

#include <algorithm>

namespace aurasim::core {

Vicinity::Vicinity(const RegionMap& region_map, RegionId region, const Nearness& which)
    : map(region_map), self(region), nearness(which), neighbours(regions_near(region_map, which, region)) {}

void Vicinity::listen_to(RegionId id) {
  const auto place = std::lower_bound(neighbours.begin(), neighbours.end(), id);
  if (place == neighbours.end() || *place != id) neighbours.insert(place, id);
}

Audience Vicinity::within(const Vec3& p, double distance_m) const {
  Audience near = kNobodyListens;
  for (const RegionId id : neighbours) {
    if (map.distance(id, p) <= distance_m) near |= audience_of(id);
  }
  return near;
}

Audience Vicinity::within(const Rectangle& box, double distance_m) const {
  Audience near = kNobodyListens;
  for (const RegionId id : neighbours) {
    if (map.region(id).distance(box) <= distance_m) near |= audience_of(id);
  }
  return near;
}

bool Vicinity::deep_inside(const Vec3& p, double distance_m) const {
  const Rectangle& r = home();
  return p.x() - r.x0 > distance_m && r.x1 - p.x() > distance_m && p.y() - r.y0 > distance_m &&
         r.y1 - p.y() > distance_m;
}

bool Vicinity::is_neighbour(RegionId id) const { return std::binary_search(neighbours.begin(), neighbours.end(), id); }

bool Vicinity::are_near(RegionId a, RegionId b) const { return core::are_near(map, nearness, a, b); }

Audience Vicinity::bit_of(RegionId id) const { return is_neighbour(id) ? audience_of(id) : kNobodyListens; }

}  // namespace aurasim::core
