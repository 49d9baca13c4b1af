#include "core/introductions.h"

#include <algorithm>
#include <cmath>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

/// Where states are checked, bodies are believed to keep to their paths (InterestMatching::zone_of).
bool keep_to_paths(const Aura& aura) { return aura.rules().redo && aura.predicts(); }

/// How far a body may come until an introduction takes effect and its aura has then been acted upon, in metres: that
/// far from its place its surface and its contact margin end. `others_top_speed_m_s` adds the way of what it may meet;
/// 0: that has a reach of its own. Where bodies keep to their paths only the way across counts, because what falls
/// comes no nearer to another region.
double reach_m(const Aura& aura, const Path& path, double others_top_speed_m_s) {
  const AuraRules& rules = aura.rules();
  const double steps = path.age_steps + static_cast<double>(horizon::introduction(rules.lookahead));
  const double speed = std::max(path.speed_m_s, path.v_WB.norm());
  const double along = keep_to_paths(aura) ? std::hypot(path.v_WB.x(), path.v_WB.y()) : path.v_WB.norm();
  const double drift = along + rules.uncertainty * path.speed_m_s;
  const double zone_speed = keep_to_paths(aura) ? drift / (1 + rules.uncertainty) : speed;
  return path.radius_m + aura.zone(zone_speed, horizon::kMostHops, others_top_speed_m_s, path.radius_m) +
         steps * rules.step_s * drift;
}

/// Regions within this distance of a body have to know of it. Their bodies may be as fast as the fastest one.
double reach_of_regions_m(const Aura& aura, const Path& path, double others_top_speed_m_s) {
  return reach_m(aura, path, std::max({others_top_speed_m_s, path.speed_m_s, path.v_WB.norm()}));
}

/// Two bodies may come together if the distance between them is at most the sum of theirs.
double reach_of_pairs_m(const Aura& aura, const Path& path) { return reach_m(aura, path, 0); }

/// Adds what a body of `host` at `p` may reach, if it may come to `territory`. Where bodies are not believed to keep to
/// their paths, one that is over it already may come to all of it, however slow it is: a blow that nobody expects may
/// make it faster.
void add_to(HostsReaches& reaches, const Aura& aura, const Rectangle& territory, RegionId host, const Vec3& p,
            double reach_m) {
  if (territory.distance(p.x(), p.y()) > reach_m) return;
  const Rectangle reach{p.x() - reach_m, p.y() - reach_m, p.x() + reach_m, p.y() + reach_m};
  const bool goes_anywhere = !keep_to_paths(aura) && territory.contains(p.x(), p.y());
  reaches.add(host, goes_anywhere ? hull_of(reach, territory) : reach);
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

void HostsReaches::group_by_host() {
  std::ranges::stable_sort(bodies_, {}, &Reach::host);
  hosts_.clear();
  for (auto first = bodies_.begin(); first != bodies_.end();) {
    Host host{first->host, first->reach, {}};
    auto end = first;
    for (; end != bodies_.end() && end->host == host.id; ++end) host.reach = hull_of(host.reach, end->reach);
    host.bodies = {first, end};
    hosts_.push_back(host);
    first = end;
  }
}

bool HostsReaches::may_meet(const Host& one, const Host& other) {
  if (one.reach.distance(other.reach) > 0) return false;
  return std::ranges::any_of(one.bodies, [&](const Reach& a) {
    return a.reach.distance(other.reach) <= 0 &&
           std::ranges::any_of(other.bodies, [&](const Reach& b) { return a.reach.distance(b.reach) <= 0; });
  });
}

template <class IsWanted, class Visit>
void HostsReaches::for_each_meeting(IsWanted&& is_wanted, Visit&& visit) {
  group_by_host();
  for (std::size_t i = 0; i < hosts_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const RegionId a = hosts_[j].id, b = hosts_[i].id;
      if (is_wanted(a, b) && may_meet(hosts_[j], hosts_[i])) visit(a, b);
    }
  }
}

Introducer::Introducer(const Aura& aura, const Vicinity& vicinity)
    : aura_(aura), vicinity_(vicinity), all_are_near_(every_region_is_near(vicinity)) {}

/// False if they listen to each other in any case, or if one of the two does not listen to us.
bool Introducer::may_introduce(RegionId a, RegionId b) const {
  const auto hears = [this](RegionId region) { return region == vicinity_.self || vicinity_.is_neighbour(region); };
  return a != b && !vicinity_.are_near(a, b) && hears(a) && hears(b);
}

void Introducer::introduce(RegionId a, RegionId b) {
  if (may_introduce(a, b)) found_.push_back({std::min(a, b), std::max(a, b)});
}

const std::vector<Introduction>& Introducer::look(const ForeignBodies& foreign, double others_top_speed_m_s) {
  found_.clear();
  guests_.clear();
  if (all_are_near_) return found_;
  for (std::uint32_t i = 0; i < foreign.size(); ++i) {
    const Foreign& body = foreign[i];
    const Vec3& p = body.path.pose.p_WB;
    const bool at_home = vicinity_.map.region(body.host).contains(p.x(), p.y());
    const double reach = reach_of_regions_m(aura_, body.path, others_top_speed_m_s);
    const double reach_of_pairs = reach_of_pairs_m(aura_, body.path);
    add_to(guests_, aura_, vicinity_.home(), body.host, p, reach_of_pairs);
    if (at_home && reach <= vicinity_.nearness.distance_m) continue;
    for (std::uint32_t q = 0; q < vicinity_.map.size(); ++q) {
      if (vicinity_.map.distance(RegionId{q}, p) <= reach) introduce(body.host, RegionId{q});
    }
  }
  guests_.for_each_meeting([this](RegionId a, RegionId b) { return may_introduce(a, b); },
                           [this](RegionId a, RegionId b) { introduce(a, b); });
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
  std::vector<double> reaches, reaches_of_pairs;
  for (const Path& path : paths) {
    reaches.push_back(reach_of_regions_m(aura, path, top_speed_m_s));
    reaches_of_pairs.push_back(reach_of_pairs_m(aura, path));
  }
  std::vector<RegionId> related;
  const auto is_far = [&](RegionId other) {
    return map.region(self).distance(map.region(other)) > neighbour_distance_m;
  };
  const auto relate = [&](RegionId a, RegionId b) {
    if (a != b && (a == self || b == self) && is_far(a == self ? b : a)) related.push_back(a == self ? b : a);
  };
  HostsReaches there;
  for (std::uint32_t q = 0; q < map.size(); ++q) {
    there.clear();
    for (std::size_t i = 0; i < hosts.size(); ++i) {
      const Vec3& p = paths[i].pose.p_WB;
      if (map.distance(RegionId{q}, p) <= reaches[i]) relate(hosts[i], RegionId{q});
      add_to(there, aura, map.region(RegionId{q}), hosts[i], p, reaches_of_pairs[i]);
    }
    there.for_each_meeting([&](RegionId a, RegionId b) { return a == self || b == self; }, relate);
  }
  std::sort(related.begin(), related.end());
  related.erase(std::unique(related.begin(), related.end()), related.end());
  return related;
}

}  // namespace aurasim::core
