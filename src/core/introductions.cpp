#include "core/introductions.h"

#include <algorithm>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

/// Regions within this distance of a body have to know of it by the time that an introduction takes effect.
double reach_m(const Aura& aura, const Path& path, double others_top_speed_m_s) {
  const AuraRules& rules = aura.rules();
  const double steps = path.age_steps + static_cast<double>(horizon::introduction(rules.lookahead));
  const double speed = std::max(path.speed_m_s, path.v_WB.norm());
  return path.radius_m + aura.zone(speed, horizon::kMostHops, std::max(others_top_speed_m_s, speed), path.radius_m) +
         steps * rules.step_s * (path.v_WB.norm() + rules.uncertainty * path.speed_m_s);
}

void sort_out(std::vector<Introduction>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

bool every_region_is_near(const Vicinity& vicinity) {
  const auto regions = static_cast<std::uint32_t>(vicinity.map.size());
  for (std::uint32_t a = 0; a < regions; ++a) {
    for (std::uint32_t b = a + 1; b < regions; ++b) {
      if (!vicinity.are_near(RegionId{a}, RegionId{b})) return false;
    }
  }
  return true;
}

}  // namespace

Introducer::Introducer(const Aura& aura, const Vicinity& vicinity)
    : aura_(aura), vicinity_(vicinity), all_are_near_(every_region_is_near(vicinity)) {}

void Introducer::introduce(RegionId a, RegionId b) {
  if (a == b || vicinity_.are_near(a, b)) return;
  if (!vicinity_.is_neighbour(a) || !vicinity_.is_neighbour(b)) return;  // one of the two does not listen to us
  found_.push_back({std::min(a, b), std::max(a, b)});
}

const std::vector<Introduction>& Introducer::look(const ForeignBodies& foreign, double others_top_speed_m_s) {
  found_.clear();
  guests_.clear();
  if (all_are_near_) return found_;
  for (std::uint32_t i = 0; i < foreign.size(); ++i) {
    const Foreign& body = foreign[i];
    const Vec3& p = body.path.pose.p_WB;
    const bool at_home = vicinity_.map.region(body.host).contains(p.x(), p.y());
    const double reach = reach_m(aura_, body.path, others_top_speed_m_s);
    if (vicinity_.home().distance(p.x(), p.y()) <= reach) guests_.push_back(body.host);
    if (at_home && reach <= vicinity_.neighbour_distance_m) continue;
    for (std::uint32_t q = 0; q < vicinity_.map.size(); ++q) {
      if (vicinity_.map.distance(RegionId{q}, p) <= reach) introduce(body.host, RegionId{q});
    }
  }
  std::sort(guests_.begin(), guests_.end());
  guests_.erase(std::unique(guests_.begin(), guests_.end()), guests_.end());
  for (std::size_t i = 0; i < guests_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) introduce(guests_[i], guests_[j]);
  }
  sort_out(found_);
  return found_;
}

std::vector<RegionId> related_at_start(const Aura& aura, const RegionMap& map, double neighbour_distance_m,
                                       RegionId self, const Snapshot& scene, std::span<const RegionId> hosts) {
  std::vector<std::vector<RegionId>> hosts_near(map.size());  // by region: hosts of the bodies near it
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    Path path = path_of(scene.bodies[i], scene.step, aura.clearance());
    path.speed_m_s = aura.speed_of(scene.bodies[i]);
    const double reach = reach_m(aura, path, aura.rules().top_speed_m_s);
    for (std::uint32_t q = 0; q < map.size(); ++q) {
      if (map.distance(RegionId{q}, path.pose.p_WB) <= reach) hosts_near[q].push_back(hosts[i]);
    }
  }
  std::vector<RegionId> related;
  for (std::uint32_t q = 0; q < map.size(); ++q) {
    std::vector<RegionId>& there = hosts_near[q];
    there.push_back(RegionId{q});
    if (std::find(there.begin(), there.end(), self) == there.end()) continue;
    for (const RegionId other : there) {
      if (other != self && map.region(self).distance(map.region(other)) > neighbour_distance_m)
        related.push_back(other);
    }
  }
  std::sort(related.begin(), related.end());
  related.erase(std::unique(related.begin(), related.end()), related.end());
  return related;
}

}  // namespace aurasim::core
