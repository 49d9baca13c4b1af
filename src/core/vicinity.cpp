#include "core/vicinity.h"

#include <algorithm>

namespace aurasim::core {

Vicinity::Vicinity(const RegionMap& region_map, RegionId region, double distance_m)
    : map(region_map),
      self(region),
      neighbour_distance_m(distance_m),
      neighbours(region_map.neighbours(region, distance_m)) {}

void Vicinity::listen_to(RegionId id) {
  const auto place = std::lower_bound(neighbours.begin(), neighbours.end(), id);
  if (place == neighbours.end() || *place != id) neighbours.insert(place, id);
}

std::uint64_t Vicinity::within(const Vec3& p, double distance_m) const {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (map.distance(neighbours[i], p) <= distance_m) bits |= std::uint64_t{1} << (i % 64);
  }
  return bits;
}

bool Vicinity::deep_inside(const Vec3& p, double distance_m) const {
  const Rectangle& r = home();
  return p.x() - r.x0 > distance_m && r.x1 - p.x() > distance_m && p.y() - r.y0 > distance_m &&
         r.y1 - p.y() > distance_m;
}

bool Vicinity::is_neighbour(RegionId id) const { return std::binary_search(neighbours.begin(), neighbours.end(), id); }

bool Vicinity::are_near(RegionId a, RegionId b) const {
  return map.region(a).distance(map.region(b)) <= neighbour_distance_m;
}

std::uint64_t Vicinity::bit_of(RegionId id) const {
  const auto found = std::lower_bound(neighbours.begin(), neighbours.end(), id);
  return found != neighbours.end() && *found == id ? std::uint64_t{1} << ((found - neighbours.begin()) % 64) : 0;
}

}  // namespace aurasim::core
