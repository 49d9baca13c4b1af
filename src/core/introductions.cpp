#include "core/introductions.h"

#include <algorithm>
#include <cmath>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

/// Regions within this distance of a body have to know of it by the time that an introduction takes effect. Where
/// states are checked, bodies are believed to keep to their paths (InterestMatching::zone_of), and what falls comes no
/// nearer to another region.
double reach_m(const Aura& aura, const Path& path, double others_top_speed_m_s) {
  const AuraRules& rules = aura.rules();
  const double steps = path.age_steps + static_cast<double>(horizon::introduction(rules.lookahead));
  const double speed = std::max(path.speed_m_s, path.v_WB.norm());
  const bool keeps_to_path = rules.redo && aura.predicts();
  const double along = keeps_to_path ? std::hypot(path.v_WB.x(), path.v_WB.y()) : path.v_WB.norm();
  const double drift = along + rules.uncertainty * path.speed_m_s;
  const double zone_speed = keeps_to_path ? drift / (1 + rules.uncertainty) : speed;
  return path.radius_m +
         aura.zone(zone_speed, horizon::kMostHops, std::max(others_top_speed_m_s, speed), path.radius_m) +
         steps * rules.step_s * drift;
}

/// Adds what a body of `host` at `p` may reach, if it may come to `territory`. One that is over it already may come to
/// all of it, however slow it is: a blow that nobody expects may make it faster.
void add_to(std::vector<HostsReach>& reaches, const Rectangle& territory, RegionId host, const Vec3& p,
            double reach_m) {
  if (territory.distance(p.x(), p.y()) > reach_m) return;
  Rectangle reach{p.x() - reach_m, p.y() - reach_m, p.x() + reach_m, p.y() + reach_m};
  if (territory.contains(p.x(), p.y())) reach = hull_of(reach, territory);
  const auto known = std::ranges::find(reaches, host, &HostsReach::host);
  if (known == reaches.end()) {
    reaches.push_back({host, reach});
  } else {
    known->reach = hull_of(known->reach, reach);
  }
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
    add_to(guests_, vicinity_.home(), body.host, p, reach);
    if (at_home && reach <= vicinity_.neighbour_distance_m) continue;
    for (std::uint32_t q = 0; q < vicinity_.map.size(); ++q) {
      if (vicinity_.map.distance(RegionId{q}, p) <= reach) introduce(body.host, RegionId{q});
    }
  }
  for (std::size_t i = 0; i < guests_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (guests_[i].reach.distance(guests_[j].reach) <= 0) introduce(guests_[i].host, guests_[j].host);
    }
  }
  sort_out(found_);
  return found_;
}

std::vector<RegionId> related_at_start(const Aura& aura, const RegionMap& map, double neighbour_distance_m,
                                       RegionId self, const Snapshot& scene, std::span<const RegionId> hosts) {
  std::vector<Path> paths;
  double top_speed_m_s = 0;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    paths.push_back(path_of(scene.bodies[i], scene.step, aura.clearance()));
    paths.back().speed_m_s = aura.speed_of(scene.bodies[i]);
    top_speed_m_s = std::max(top_speed_m_s, paths.back().speed_m_s);
  }
  std::vector<std::vector<HostsReach>> near(map.size());  // by region: who may come to it, its owner first
  for (std::uint32_t q = 0; q < map.size(); ++q) near[q].push_back({RegionId{q}, map.region(RegionId{q})});
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    const double reach = reach_m(aura, paths[i], top_speed_m_s);
    for (std::uint32_t q = 0; q < map.size(); ++q) {
      add_to(near[q], map.region(RegionId{q}), hosts[i], paths[i].pose.p_WB, reach);
    }
  }
  std::vector<RegionId> related;
  for (const std::vector<HostsReach>& there : near) {
    const auto own = std::ranges::find(there, self, &HostsReach::host);
    if (own == there.end()) continue;
    for (const HostsReach& other : there) {
      const bool is_near = map.region(self).distance(map.region(other.host)) <= neighbour_distance_m;
      if (!is_near && own->reach.distance(other.reach) <= 0) related.push_back(other.host);
    }
  }
  std::sort(related.begin(), related.end());
  related.erase(std::unique(related.begin(), related.end()), related.end());
  return related;
}

}  // namespace aurasim::core
