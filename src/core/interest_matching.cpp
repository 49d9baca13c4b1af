#include "core/interest_matching.h"

#include <algorithm>
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
    : aura_(aura), vicinity_(vicinity), together_(together), clusters_(aura), own_(aura, vicinity) {}

void InterestMatching::look(const Snapshot& snapshot, std::span<const Neighbour> neighbours,
                            std::span<const AuraRecord> ghosts) {
  own_.look(snapshot);
  clear_marks();
  gather_foreign(snapshot, neighbours, ghosts);
  find_zones();
  bring_together(snapshot);
  form_clusters(snapshot);
  notice();
  pairs_.clear();
  for (const ForeignBlock& block : foreign_.blocks()) {
    Progress::mark();
    find_pairs(block);
  }
  judge();
}

/// Forgets what the last state has shown of bodies and clusters.
void InterestMatching::clear_marks() {
  if (!own_.goes_on()) {
    audiences_.assign(own_.size(), kNobodyListens);
    hops_.assign(own_.size(), 1);
    verdicts_.assign(own_.size(), {vicinity_.self});
  } else {
    for (const std::uint32_t i : near_others_) {
      audiences_[i] = kNobodyListens;
      hops_[i] = 1;
    }
    clear_verdicts();
  }
  announced_.clear();
}

void InterestMatching::clear_verdicts() {
  for (const std::uint32_t cluster : judged_) verdicts_[cluster] = {vicinity_.self};
  judged_.clear();
}

void InterestMatching::form_clusters(const Snapshot& snapshot) {
  if (own_.goes_on()) {
    clusters_.go_on(own_.paths(), hops_, snapshot.contacts, snapshot.joints,
                    {own_.changed(), snapshot.changed_contacts});
  } else {
    clusters_.begin(own_.paths(), hops_, snapshot.contacts, snapshot.joints);
  }
  for (const Contact& pair : joined_) clusters_.hold_together(pair.a, pair.b);
  clusters_.note_outside(outside_);
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
        announce(*own, kAllListeners);  // two nodes host it, and the one with the lower epoch has to let go
      }
    }
  }
  for (const AuraRecord& ghost : ghosts) {
    if (!own_.find(ghost.id)) foreign_.add(ghost, ghost.stamp, snapshot.step, aura_);
  }
  foreign_.build();
  others_top_radius_ = std::max(others_top_radius_, own_.top_radius());
}

/// Finds foreign bodies near ours, and which of ours have to be announced because of them.
void InterestMatching::notice() {
  for (const std::uint32_t i : expecting_) announce(i, kAllListeners);
  for (const ForeignBlock& block : foreign_.blocks()) {
    Progress::mark();
    notice(block);
  }
  keep_one_of_each(announced_);
  near_others_.clear();
  std::ranges::set_union(own_.close(), announced_, std::back_inserter(near_others_));
}

void InterestMatching::announce(std::uint32_t own, Audience regions) {
  audiences_[own] |= regions;
  announced_.push_back(own);
}

/// Fills places_ with the bodies of the block, and ranges_ with range_of(body, hops) of them.
template <class RangeOf>
void InterestMatching::take_ranges(const ForeignBlock& block, RangeOf&& range_of) {
  places_.clear();
  ranges_.clear();
  ranges_each_ = static_cast<std::size_t>(aura_.rules().most_hops() + homeward_hops());
  for (const std::uint32_t f : block.bodies) {
    const Path& path = foreign_[f].path;
    places_.push_back({path.pose.p_WB, path.radius_m});
    for (std::size_t h = 1; h <= ranges_each_; ++h) ranges_.push_back(range_of(path, static_cast<int>(h)));
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
  const double range = ranges_[k * ranges_each_ + own.hops - 1].at(own.speed_m_s);
  return is_within(places_[k].p_WB, places_[k].radius_m, own.p_WB, own.radius_m, range);
}

/// Finds our bodies that have to be announced because foreign ones are near. Most of them are known already: their
/// zones reach into that host's territory, or they lie in a pile.
void InterestMatching::notice(const ForeignBlock& block) {
  const bool listens = vicinity_.is_neighbour(block.host);
  const Audience regions = listens ? audience_of(block.host) : kAllListeners;
  take_ranges(block, [&](const Path& path, int hops) { return aura_.notice(path.speed_m_s, path.age_steps, hops); });
  candidates_.clear();
  const auto range_at = [this](double speed_m_s) { return widest_range(speed_m_s); };
  clusters_.near().for_each_near(block.lo, block.hi, range_at, [&](std::uint32_t i) {
    if ((regions & ~audiences_[i]) == kNobodyListens) return;
    candidates_.push_back(candidate(i, own_.path(i).speed_m_s, homeward_hops()));
  });
  for (const Candidate& c : candidates_) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (!is_in_range(k, c) ||
          !aura_.may_approach(foreign_[block.bodies[k]].path, own_.path(c.own), static_cast<int>(c.hops))) {
        continue;
      }
      announce(c.own, regions);
      break;
    }
  }
}

InterestMatching::Candidate InterestMatching::candidate(std::uint32_t own, double speed_m_s, int more_hops) const {
  const auto hops = static_cast<std::size_t>(hops_[own] + more_hops);
  return {own_.path(own).pose.p_WB, own_.path(own).radius_m, speed_m_s, hops, own};
}

/// Finds pairs of a foreign and an own body that may meet. Such bodies have been noticed before, because meetings reach
/// less far than notice. Of those that have a way home, also pairs that may meet some hops later (judge_expected()).
///
/// Where states are checked, a host that pulls nothing from here matters to our bodies outside our region only: it
/// keeps them from going home.
void InterestMatching::find_pairs(const ForeignBlock& block) {
  const double drift = 1 + aura_.rules().uncertainty;  // upper bound of Aura::drift_m_s() for each m/s of top speed
  take_ranges(block, [&](const Path& path, int hops) { return aura_.meet_range(path, hops); });
  candidates_.clear();
  const auto range_at = [&](double speed_m_s) { return widest_range(drift * speed_m_s); };
  const auto take = [&](std::uint32_t i) {
    candidates_.push_back(candidate(i, aura_.drift_m_s(own_.path(i)), outside(i) ? homeward_hops() : 0));
  };
  if (!aura_.rules().redo || pulls_from(block.host, vicinity_.self)) {
    clusters_.near().for_each_near(block.lo, block.hi, range_at, take);
  } else {
    std::ranges::for_each(outside_, take);
  }
  for (std::size_t k = 0; k < block.bodies.size(); ++k) {
    for (const Candidate& c : candidates_) {
      if (is_in_range(k, c)) pairs_.push_back({block.bodies[k], c.own});
    }
  }
}

}  // namespace aurasim::core
