#include "core/gathering.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/aura_precision.h"

namespace aurasim::core {

namespace {

/// A cluster goes home only if nothing is expected to meet it for K steps more than an aura looks ahead: that long, the
/// others may act upon auras from before it left. So auras have to be known that much earlier, too.
constexpr int kHomewardHops = 1;

}  // namespace

Gathering::Gathering(const Aura& aura, const Vicinity& vicinity) : aura_(aura), vicinity_(vicinity), clusters_(aura) {}

void Gathering::look(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                     std::span<const AuraRecord> ghosts, const Ranks& ranks) {
  const int hops_each = ranks.changing() ? 2 : 1;
  measure(snapshot);
  gather_foreign(snapshot, neighbours, ghosts);
  mark_regions(hops_each);
  clusters_.begin(paths_, own_speeds_, regions_, snapshot.contacts, snapshot.joints, hops_each);
  complete_near_boundaries();
  pair_up();
  judge(ranks);
}

void Gathering::measure(const Snapshot& snapshot) {
  const auto n = snapshot.bodies.size();
  ids_.resize(n);
  paths_.resize(n);
  speeds_.resize(n);
  own_speeds_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const BodyState& body = snapshot.bodies[i];
    ids_[i] = body.id;
    speeds_[i] = aura_.speed_of(body);
    own_speeds_[i] = aura_.own_speed_of(body);
    paths_[i] = path_of(body, snapshot.step, aura_.clearance());
  }
}

void Gathering::gather_foreign(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                               std::span<const AuraRecord> ghosts) {
  foreign_.clear();
  live_.clear();
  others_top_speed_ = others_top_radius_ = 0;
  const auto is_local = [&](BodyId id) {
    const auto found = std::lower_bound(snapshot.bodies.begin(), snapshot.bodies.end(), id,
                                        [](const BodyState& b, BodyId x) { return b.id < x; });
    return found != snapshot.bodies.end() && found->id == id;
  };
  for (const Neighbour& neighbour : neighbours) {
    if (!neighbour.alive()) continue;
    live_.push_back(neighbour.id());
    // Before the first word of a neighbour, the promised top speed has to do.
    const bool silent = neighbour.applied() < 0;
    others_top_speed_ = std::max(others_top_speed_, silent ? aura_.rules().top_speed_m_s : neighbour.top_speed_m_s());
    others_top_radius_ = std::max(others_top_radius_, neighbour.top_radius_m());
    for (const AuraRecord& aura : neighbour.auras()) {
      if (!is_local(aura.id)) add_foreign(aura, neighbour.applied(), snapshot.step);
    }
  }
  for (const AuraRecord& ghost : ghosts) {
    if (!is_local(ghost.id)) add_foreign(ghost, ghost.stamp, snapshot.step);
  }
}

void Gathering::add_foreign(const AuraRecord& aura, Step known, Step now) {
  const bool asleep = (aura.flags & kAuraAsleep) != 0;
  const bool ghost = (aura.flags & kAuraGhost) != 0;
  Foreign& f = foreign_.emplace_back();
  f.id = aura.id;
  f.host = aura.host;
  f.ghost = ghost;
  f.born = aura.birth <= aura.stamp;
  f.path.prototype = aura.prototype;
  f.path.radius_m = aura_.clearance().bounding_radius(aura.prototype);
  f.path.pose = aura.pose;
  f.path.v_WB = aura.v_WB;
  f.path.w_WB = aura.w_WB;
  f.path.moves = !asleep;
  // Asleep and unchanged in its source's last batch: as fresh as that batch. A ghost has been out of sight since.
  f.path.age_steps =
      static_cast<double>(std::max<Step>(0, now - std::max(asleep && !ghost ? known : aura.stamp, aura.birth)));
  f.path.unborn_steps = static_cast<double>(std::max<Step>(0, aura.birth - now));
  f.path.speed_m_s = aura.speed_m_s;
  f.path.blur_m = said_within_m(f.path.radius_m);
  f.strike = strike_of(aura);
}

double Gathering::band(double speed_m_s, int hops) const {
  return aura_.zone(speed_m_s, hops, std::max(others_top_speed_, speed_m_s), others_top_radius_);
}

/// Which regions are in reach of each body. Where several are, pulls can chain, and the reach grows with them.
void Gathering::mark_regions(int hops_each) {
  const auto n = paths_.size();
  regions_.assign(n, 0);
  near_.clear();
  double top_speed = NearIndex::kSlow;
  for (std::size_t i = 0; i < n; ++i) {
    top_speed = std::max(top_speed, speeds_[i]);
    others_top_radius_ = std::max(others_top_radius_, paths_[i].radius_m);
  }
  const double slow_band = band(NearIndex::kSlow, hops_each + kHomewardHops);
  const double fast_band = band(top_speed, hops_each + kHomewardHops);
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool slow = speeds_[i] <= NearIndex::kSlow;
    const Vec3& p = paths_[i].pose.p_WB;
    if (vicinity_.deep_inside(p, (slow ? slow_band : fast_band) + paths_[i].radius_m)) continue;
    near_.push_back(i);
    int hops = 0;
    for (int found = 1; found > hops; found = std::popcount(regions_[i])) {
      hops = found;
      regions_[i] =
          vicinity_.within(p, band(slow ? NearIndex::kSlow : top_speed, hops_each * hops) + paths_[i].radius_m);
    }
  }
}

void Gathering::complete_near_boundaries() {
  for (const std::uint32_t i : near_) clusters_.complete(i);
}

/// Foreign auras and our bodies near them. A cluster that is completed here, or hit, may turn out faster, and then
/// reach further: repeated until nothing changes.
void Gathering::pair_up() {
  noticed_.assign(paths_.size(), 0);
  noticed_by_.assign(paths_.size(), 0);
  group_noticed_.assign(clusters_.near().group_count(), 0);
  group_noticed_by_.assign(clusters_.near().group_count(), 0);
  std::uint64_t growth = 0;
  do {
    growth = clusters_.growth();
    news_.clear();
    for (const Foreign& foreign : foreign_) notice(foreign);
    for (const News& news : news_) {
      clusters_.add_regions(news.own, news.region);
      clusters_.complete(news.own);
    }
    if (growth != clusters_.growth()) continue;
    find_pairs();
    take_hits();
  } while (growth != clusters_.growth());
}

/// What is hit has to be known as that fast before it is, or whoever stands behind it learns of it too late: others act
/// upon our auras when they are K states old, and look that much further ahead.
void Gathering::take_hits() {
  if (aura_.rules().kind != AuraKind::kSwept) return;
  for (const Pair& pair : pairs_) {
    const Foreign& f = foreign_[pair.foreign];
    if (!clusters_.feels(f.strike, pair.own)) continue;
    const int hops = clusters_.hops(pair.own) + kHomewardHops;
    const std::optional<double> first = aura_.first_meeting(f.path, paths_[pair.own], hops);
    if (first) clusters_.hit(pair.own, f.strike.times(1 - *first / ((hops + 2) * aura_.rules().lookahead)));
  }
}

Strike Gathering::strike_of(const AuraRecord& aura) const {
  const BodyTraits traits = aura_.clearance().traits(aura.prototype);
  const double alone_m_s = std::max(0.0, aura.speed_m_s - aura_.calm_speed(true));
  const Push own = aura.pushed_m_s > 0 ? Push::of(aura.v_WB.norm(), traits, aura_.rules().uncertainty)
                                       : Push{alone_m_s, traits.mass_kg * alone_m_s};
  return {own, {aura.pushed_m_s, aura.pushed_kg_m_s}};
}

/// Which of our bodies have to be announced because of a foreign one? In a heap most of them are already.
void Gathering::notice(const Foreign& foreign) {
  const Path& path = foreign.path;
  const std::uint64_t region = vicinity_.bit_of(foreign.host);
  const NearIndex& near = clusters_.near();
  ranges_.clear();
  for (int hops = 0; hops <= clusters_.most_hops() + kHomewardHops; ++hops) {
    ranges_.push_back(aura_.notice(path.speed_m_s, path.age_steps, hops));
  }
  const auto knows = [&](std::uint32_t i) { return noticed_[i] && (noticed_by_[i] & region) == region; };
  const auto all_know = [&](std::uint32_t group) {
    const bool known = group_noticed_[group] && (group_noticed_by_[group] & region) == region;
    if (known || !knows(near.any_of(group)) || !near.all_of(group, knows)) return known;
    group_noticed_[group] = 1;
    group_noticed_by_[group] |= region;
    return true;
  };
  near.for_each_near(path.pose.p_WB, path.radius_m, ranges_.back().at(NearIndex::kSlow), ranges_.back().at(top_speed()),
                     all_know, [&](std::uint32_t i) {
                       if (knows(i)) return;
                       const Path& own = paths_[i];
                       const auto hops = static_cast<std::size_t>(clusters_.hops(i) + kHomewardHops);
                       const double reach = path.radius_m + own.radius_m + ranges_[hops].at(own.speed_m_s);
                       if ((path.pose.p_WB - own.pose.p_WB).squaredNorm() > reach * reach) return;
                       noticed_[i] = 1;
                       noticed_by_[i] |= region;
                       news_.push_back({i, region});
                     });
}

/// Who may meet whom. Whoever does has been noticed: meeting looks less far.
void Gathering::find_pairs() {
  pairs_.clear();
  double slow_drift = 0;
  double fast_drift = 0;
  drifts_.clear();
  for (const Path& own : paths_) {
    drifts_.push_back(aura_.drift_m_s(own));
    double& most = own.speed_m_s <= NearIndex::kSlow ? slow_drift : fast_drift;
    most = std::max(most, drifts_.back());
  }
  for (std::uint32_t f = 0; f < foreign_.size(); ++f) {
    const Path& path = foreign_[f].path;
    ranges_.clear();
    for (int hops = 0; hops <= clusters_.most_hops() + kHomewardHops; ++hops) {
      ranges_.push_back(aura_.meet_range(path, hops));
    }
    clusters_.near().for_each_near(path.pose.p_WB, path.radius_m, ranges_.back().at(slow_drift),
                                   ranges_.back().at(fast_drift), [&](std::uint32_t i) {
                                     const Path& own = paths_[i];
                                     const auto hops = static_cast<std::size_t>(clusters_.hops(i) + kHomewardHops);
                                     const double reach = path.radius_m + own.radius_m + ranges_[hops].at(drifts_[i]);
                                     if ((path.pose.p_WB - own.pose.p_WB).squaredNorm() <= reach * reach)
                                       pairs_.push_back({f, i});
                                   });
  }
}

void Gathering::judge(const Ranks& ranks) {
  touched_.assign(paths_.size(), 0);
  expected_.assign(paths_.size(), 0);
  pulled_to_.assign(paths_.size(), vicinity_.self);
  for (const Pair& pair : pairs_) judge(pair, ranks);
}

bool Gathering::meets(const Foreign& foreign, const Path& own, int hops, int fewer_steps) const {
  return foreign.ghost ? aura_.meets_ghost(foreign.path, own, hops, fewer_steps)
                       : aura_.meets(foreign.path, own, hops, fewer_steps);
}

void Gathering::judge(const Pair& pair, const Ranks& ranks) {
  const Foreign& f = foreign_[pair.foreign];
  const Path& own = paths_[pair.own];
  const std::uint32_t cluster = clusters_.of(pair.own);
  const int hops = clusters_.hops(pair.own);
  const bool pulls = f.host != pulled_to_[cluster] && std::binary_search(live_.begin(), live_.end(), f.host) &&
                     ranks.pulls(f.host) && ranks.outranks(f.host, pulled_to_[cluster]);
  const int fewer_steps = ranks.changing() ? 1 : 0;  // 2 h K - 1 are enough (docs/decisions/0016-ranks.md)
  if ((!touched_[cluster] || pulls) && meets(f, own, hops, fewer_steps)) {
    touched_[cluster] = 1;
    if (pulls) pulled_to_[cluster] = f.host;
  }
  if (touched_[cluster] || expected_[cluster] || !outside(pair.own)) return;
  expected_[cluster] = meets(f, own, hops + kHomewardHops) ? 1 : 0;
}

bool Gathering::must_be_announced(std::uint32_t i) const {
  if (aura_.rules().kind == AuraKind::kNone) return false;
  if (noticed_[i]) return true;
  const double reach = band(clusters_.speed(i), clusters_.hops(i) + kHomewardHops) + paths_[i].radius_m;
  return !vicinity_.deep_inside(paths_[i].pose.p_WB, reach);
}

bool Gathering::outside(std::uint32_t i) const {
  const Vec3& p = paths_[i].pose.p_WB;
  if (aura_.rules().kind == AuraKind::kNone) return !vicinity_.home().contains(p.x(), p.y());
  return vicinity_.home().distance(p.x(), p.y()) > paths_[i].radius_m;
}

}  // namespace aurasim::core
