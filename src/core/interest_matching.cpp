#include "core/interest_matching.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "core/horizon.h"
#include "core/keep_one_of_each.h"
#include "core/progress.h"

namespace aurasim::core {

namespace {

/// Are two spheres, around `p` and `other`, at most `distance_m` apart?
bool is_within(const Vec3& p, double radius_m, const Vec3& other, double other_radius_m, double distance_m) {
  const double reach = radius_m + other_radius_m + distance_m;
  return reach >= 0 && (p - other).squaredNorm() <= reach * reach;
}

}  // namespace

InterestMatching::InterestMatching(const Aura& aura, const Vicinity& vicinity, std::span<const TogetherPair> together)
    : aura_(aura),
      has_narrow_regions_(vicinity.map.narrowest_m() < aura.listening_distance_m(0)),
      vicinity_(vicinity),
      together_(together),
      clusters_(aura),
      own_(aura, vicinity) {}

void InterestMatching::look(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                            std::span<const AuraRecord> ghosts) {
  own_.look(snapshot);
  clear_marks();
  gather_foreign(snapshot, neighbours, ghosts);
  mark_regions();
  bring_together(snapshot);
  form_clusters(snapshot);
  if (pulls_chain()) {
    complete_near_boundaries();
  } else {
    find_zones();
  }
  pair_up();
  if (pulls_chain()) widest_band_m_ = band(top_speed(), clusters_.most_hops() + homeward_hops());
  judge();
}

/// Forgets what the last state has shown of bodies and clusters.
void InterestMatching::clear_marks() {
  if (!own_.goes_on()) {
    const std::size_t n = own_.size();
    regions_.assign(n, 0);
    noticed_.assign(n, 0);
    noticed_by_.assign(n, kNobodyListens);
    zones_.assign(n, kNobodyListens);
    announced_to_all_.assign(n, 0);
    touched_.assign(n, 0);
    expected_.assign(n, 0);
    pulled_to_.assign(n, vicinity_.self);
  } else {
    for (const std::uint32_t i : near_) regions_[i] = 0;
    for (const std::uint32_t i : near_others_) zones_[i] = kNobodyListens;
    for (const std::uint32_t i : marked_) {
      noticed_[i] = announced_to_all_[i] = 0;
      noticed_by_[i] = kNobodyListens;
    }
    for (const std::uint32_t cluster : judged_) expected_[cluster] = 0;
    clear_judged();
  }
  near_.clear();
  marked_.clear();
  judged_.clear();
}

/// Forgets which clusters an aura has met.
void InterestMatching::clear_judged() {
  for (const std::uint32_t cluster : judged_) {
    touched_[cluster] = 0;
    pulled_to_[cluster] = vicinity_.self;
  }
}

void InterestMatching::form_clusters(const Snapshot& snapshot) {
  if (own_.goes_on()) {
    clusters_.go_on(own_.paths(), regions_, snapshot.contacts, snapshot.joints,
                    {own_.changed(), snapshot.changed_contacts, near_});
  } else {
    clusters_.begin(own_.paths(), regions_, snapshot.contacts, snapshot.joints);
  }
  for (const Contact& pair : joined_) clusters_.hold_together(pair.a, pair.b);
}

void InterestMatching::gather_foreign(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                                      std::span<const AuraRecord> ghosts) {
  foreign_.clear();
  live_.clear();
  others_top_speed_ = others_top_radius_ = 0;
  for (const Neighbour& neighbour : neighbours) {
    if (!neighbour.alive()) continue;
    live_.push_back(neighbour.id());
    // Before the first batch of a neighbour its top speed is unknown, so the promised one is used.
    const bool silent = neighbour.applied() < 0;
    others_top_speed_ = std::max(others_top_speed_, silent ? aura_.rules().top_speed_m_s : neighbour.top_speed_m_s());
    others_top_radius_ = std::max(others_top_radius_, neighbour.top_radius_m());
    for (const AuraRecord& aura : neighbour.auras()) {
      const std::optional<std::uint32_t> own = own_.find(aura.id);
      if (!own) {
        foreign_.add(aura, neighbour.applied(), snapshot.step, aura_);
      } else if ((aura.flags & kAuraGhost) == 0) {
        announced_to_all_[*own] = 1;  // two nodes host it, and the one with the lower epoch has to let go
        marked_.push_back(*own);
      }
    }
  }
  for (const AuraRecord& ghost : ghosts) {
    if (!own_.find(ghost.id)) foreign_.add(ghost, ghost.stamp, snapshot.step, aura_);
  }
  foreign_.build();
}

/// Gathers our bodies whose clusters have to be complete, whether a foreign body is near or not. Where pulls chain,
/// these are all in reach of another region, and the regions in reach of each are marked: the reach grows with their
/// number. Where states are checked pulls do not chain, and these are the bodies that may have to go home.
void InterestMatching::mark_regions() {
  const bool chains = pulls_chain();
  const double top_speed = std::max(NearIndex::kSlow, own_.top_speed());
  others_top_radius_ = std::max(others_top_radius_, own_.top_radius());
  const double slow_band = band(NearIndex::kSlow, 1 + homeward_hops());
  const double fast_band = band(top_speed, 1 + homeward_hops());
  own_.find_close(std::max(0.0, band(top_speed, horizon::kMostHops + homeward_hops())));
  for (const std::uint32_t i : own_.close()) {
    const Path& path = own_.path(i);
    const bool slow = path.speed_m_s <= NearIndex::kSlow;
    const Vec3& p = path.pose.p_WB;
    if (vicinity_.deep_inside(p, (slow ? slow_band : fast_band) + path.radius_m)) continue;
    if (chains || outside(i)) near_.push_back(i);
    if (!chains) continue;
    int hops = 0;
    for (int found = 1; found > hops; found = std::popcount(regions_[i])) {
      hops = found;
      regions_[i] = vicinity_.within(p, band(slow ? NearIndex::kSlow : top_speed, hops) + path.radius_m);
    }
  }
}

void InterestMatching::complete_near_boundaries() {
  for (const std::uint32_t i : near_) clusters_.complete(i);
  for (const std::uint32_t i : expecting_) clusters_.complete(i);
}

/// Finds foreign auras and our bodies near them. A cluster that is completed here may turn out to have more hops and
/// then reach further. So bodies that have grown are looked at again until none grows.
void InterestMatching::pair_up() {
  for (const std::uint32_t i : expecting_) {
    noticed_[i] = announced_to_all_[i] = 1;
    marked_.push_back(i);
  }
  clusters_.take_grown(grown_);  // discard: all bodies are looked at below with their present speeds
  for (const ForeignBlock& block : foreign_.blocks()) {
    Progress::mark();
    notice(block);
  }
  take_news();
  notice_grown();
  note_near_others();
  pairs_.clear();
  for (const ForeignBlock& block : foreign_.blocks()) {
    Progress::mark();
    find_pairs(block);
  }
}

/// Call once all marks are set.
void InterestMatching::note_near_others() {
  keep_one_of_each(marked_);
  near_others_.clear();
  std::ranges::set_union(own_.close(), marked_, std::back_inserter(near_others_));
}

/// Completes the clusters of bodies that foreign ones are near to, and notes their regions. Where pulls do not chain,
/// no hops depend on it, so only clusters that an aura meets are completed, and later.
void InterestMatching::take_news() {
  if (!pulls_chain()) news_.clear();
  for (const News& news : news_) {
    clusters_.add_regions(news.own, news.region);
    clusters_.complete(news.own);
  }
  news_.clear();
}

void InterestMatching::notice_grown() {
  for (clusters_.take_grown(grown_); !grown_.empty(); clusters_.take_grown(grown_)) {
    for (const std::uint32_t own : grown_) {
      Progress::mark();
      notice_again(own);
    }
    take_news();
  }
}

/// Fills places_ with the bodies of the block, and ranges_ with range_of(body, hops) of them, from `least_hops` on.
template <class RangeOf>
void InterestMatching::take_ranges(const ForeignBlock& block, int least_hops, RangeOf&& range_of) {
  const int most_hops = clusters_.most_hops() + homeward_hops();
  places_.clear();
  ranges_.clear();
  least_hops_ = pulls_chain() ? 0 : least_hops;
  ranges_each_ = static_cast<std::size_t>(most_hops - least_hops_) + 1;
  for (const std::uint32_t f : block.bodies) {
    places_.push_back({foreign_[f].path.pose.p_WB, foreign_[f].path.radius_m});
    for (int hops = least_hops_; hops <= most_hops; ++hops) ranges_.push_back(range_of(foreign_[f].path, hops));
  }
}

/// The widest range of the block at `speed_m_s`. Call after take_ranges().
double InterestMatching::widest_range(double speed_m_s) const {
  double widest_m = 0;
  for (std::size_t most = ranges_each_ - 1; most < ranges_.size(); most += ranges_each_) {
    widest_m = std::max(widest_m, ranges_[most].at(speed_m_s));
  }
  return widest_m;
}

/// Is `own` in range of the k-th body of the block? Call after take_ranges().
bool InterestMatching::is_in_range(std::size_t k, const Candidate& own) const {
  const std::size_t column = own.hops - static_cast<std::size_t>(least_hops_);
  const double range = ranges_[k * ranges_each_ + column].at(own.speed_m_s);
  return is_within(places_[k].p_WB, places_[k].radius_m, own.p_WB, own.radius_m, range);
}

/// Finds our bodies that have to be announced because foreign ones are near. Most of them are known already: their
/// zones reach into that host's territory, or they lie in a pile.
void InterestMatching::notice(const ForeignBlock& block) {
  const Audience region = vicinity_.bit_of(block.host);
  const auto knows = [&](std::uint32_t i) {
    return ((noticed_by_[i] | zones_[i]) & region) == region && (noticed_[i] || region != kNobodyListens);
  };
  take_ranges(block, clusters_.most_hops() + homeward_hops(),
              [&](const Path& path, int hops) { return aura_.notice(path.speed_m_s, path.age_steps, hops); });
  candidates_.clear();
  const auto range_at = [this](double speed_m_s) { return widest_range(speed_m_s); };
  clusters_.near().for_each_near(block.lo, block.hi, range_at, [&](std::uint32_t i) {
    if (!knows(i)) candidates_.push_back(candidate(i, own_.path(i).speed_m_s, homeward_hops()));
  });
  for (const Candidate& c : candidates_) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (!is_in_range(k, c) ||
          !aura_.may_approach(foreign_[block.bodies[k]].path, own_.path(c.own), static_cast<int>(c.hops))) {
        continue;
      }
      note(c.own, block.host);
      break;
    }
  }
}

void InterestMatching::note(std::uint32_t own, RegionId host) {
  const Audience region = vicinity_.bit_of(host);
  noticed_[own] = 1;
  marked_.push_back(own);
  noticed_by_[own] |= region;
  if (region == kNobodyListens) announced_to_all_[own] = 1;
  news_.push_back({own, region});
}

InterestMatching::Candidate InterestMatching::candidate(std::uint32_t own, double speed_m_s, int more_hops) const {
  const auto hops = static_cast<std::size_t>(clusters_.hops(own) + more_hops);
  return {own_.path(own).pose.p_WB, own_.path(own).radius_m, speed_m_s, hops, own};
}

/// Calls `visit(index)` for at least every foreign body that notices our body `own`.
template <class Visit>
void InterestMatching::for_each_foreign_near(std::uint32_t own, Visit&& visit) const {
  const Path& path = own_.path(own);
  const int hops = clusters_.hops(own) + homeward_hops();
  const auto range = [&](double speed_m_s) {
    return aura_.notice(speed_m_s, foreign_.oldest_steps(), hops).at(path.speed_m_s) + foreign_.most_blur_m();
  };
  foreign_.near().for_each_near(path.pose.p_WB, path.radius_m, range, visit);
}

/// Looks again for foreign bodies near body `own`, which has more hops than before.
void InterestMatching::notice_again(std::uint32_t own) {
  const Path& path = own_.path(own);
  const int hops = clusters_.hops(own) + homeward_hops();
  for_each_foreign_near(own, [&](std::uint32_t f) {
    const Foreign& foreign = foreign_[f];
    const Audience region = vicinity_.bit_of(foreign.host);
    if (noticed_[own] && (noticed_by_[own] & region) == region) return;
    const Range range = aura_.notice(foreign.path.speed_m_s, foreign.path.age_steps, hops);
    if (is_within(foreign.path.pose.p_WB, foreign.path.radius_m, path.pose.p_WB, path.radius_m,
                  range.at(path.speed_m_s)) &&
        aura_.may_approach(foreign.path, path, hops)) {
      note(own, foreign.host);
    }
  });
}

/// Finds pairs of a foreign and an own body that may meet. Such bodies have been noticed before, because meetings reach
/// less far than notice. Of those that have a way home, also pairs that may meet some hops later (judge_expected()).
///
/// Where pulls do not chain, a host that pulls nothing from here matters to our bodies outside our region only: it
/// keeps them from going home.
void InterestMatching::find_pairs(const ForeignBlock& block) {
  const double drift = 1 + aura_.rules().uncertainty;  // upper bound of Aura::drift_m_s() for each m/s of top speed
  take_ranges(block, clusters_.most_hops(), [&](const Path& path, int hops) { return aura_.meet_range(path, hops); });
  candidates_.clear();
  const auto range_at = [&](double speed_m_s) { return widest_range(drift * speed_m_s); };
  const auto take = [&](std::uint32_t i) {
    candidates_.push_back(candidate(i, aura_.drift_m_s(own_.path(i)), outside(i) ? homeward_hops() : 0));
  };
  if (pulls_chain() || pulls_from(block.host, vicinity_.self)) {
    clusters_.near().for_each_near(block.lo, block.hi, range_at, take);
  } else {
    std::ranges::for_each(near_, take);
  }
  for (std::size_t k = 0; k < block.bodies.size(); ++k) {
    for (const Candidate& c : candidates_) {
      if (is_in_range(k, c)) pairs_.push_back({block.bodies[k], c.own});
    }
  }
}

}  // namespace aurasim::core
