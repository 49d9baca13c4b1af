#include "core/projection.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/aura_record.h"
#include "core/horizon.h"
#include "core/prefetch.h"

namespace aurasim::core {
namespace {

/// Does `now` hold anything that other nodes cannot derive from `published`?
bool has_news(const AuraRecord& published, const AuraRecord& now) {
  const bool asleep = (now.flags & kAuraAsleep) != 0;
  return !asleep || published.flags != now.flags || published.speed_m_s != now.speed_m_s ||
         published.epoch != now.epoch || published.pose.p_WB != now.pose.p_WB || published.audience != now.audience;
}

/// Is the body near the border or outside, or has been in the state before?
bool is_busy(const Track& track) { return track.phase != Phase::kHostRegion || track.projected(); }

/// Published auras are scattered in memory and no longer cached after physics has run. Without prefetch, waiting for
/// them was most of the cost.
constexpr std::size_t kPrefetchDistance = 8;

}  // namespace

void Projection::follow(const Snapshot& snapshot) {
  const auto same = [](const Track& track, const BodyState& body) {
    return track.id == body.id && track.epoch == body.epoch;
  };
  if (std::equal(tracks_.begin(), tracks_.end(), snapshot.bodies.begin(), snapshot.bodies.end(), same)) return;
  std::swap(tracks_, before_);
  tracks_.clear();
  auto old = before_.begin();
  for (const BodyState& body : snapshot.bodies) {
    for (; old != before_.end() && old->id < body.id; ++old) note_gone(*old);
    if (old != before_.end() && old->id == body.id && old->epoch == body.epoch) {
      tracks_.push_back(std::move(*old));
    } else {
      Track& fresh = tracks_.emplace_back();
      fresh.id = body.id;
      fresh.epoch = body.epoch;
    }
    if (old != before_.end() && old->id == body.id) ++old;
  }
  for (; old != before_.end(); ++old) note_gone(*old);
}

/// Notes a projected body that left without a hand-off: an order removed it, or another node has a higher epoch of it.
void Projection::note_gone(const Track& track) {
  if (track.projected() && track.phase != Phase::kSent) gone_.push_back(track.id);
}

void Projection::take_back_gone(AuraBatch& batch) {
  for (const BodyId id : gone_) {
    const auto is_same = [id](const AuraRecord& ghost) { return ghost.id == id; };
    if (std::any_of(ghosts_.begin(), ghosts_.end(), is_same)) continue;
    ++counters_.deleted;
    batch.deletes.push_back(id);
  }
  gone_.clear();
}

void Projection::move(Track& track, PhaseEvent event) {
  const std::optional<Phase> next = next_phase(track.phase, event);
  if (!next) {
    ++counters_.bad_phase_changes;
    return;
  }
  track.phase = *next;
}

AuraRecord Projection::describe(const BodyState& body, Audience audience, Step stamp) const {
  AuraRecord aura = aura_record(body, vicinity_.self, stamp);
  if (!aura_.predicts() && !aura_.rules().redo) {  // other nodes use positions and sizes only
    aura.v_WB = aura.w_WB = Vec3::Zero();
  }
  aura.speed_m_s = aura_.speed_of(body);
  aura.audience = audience;
  return aura;
}

void Projection::publish(Track& track, const AuraRecord& aura, AuraBatch& batch, bool full) {
  if (!full && track.projected() && !has_news(track.published->newest, aura)) return;
  ++(track.projected() ? counters_.updated : counters_.created);
  if (!track.projected()) track.published = std::make_unique<Track::Published>(aura, aura);
  track.published->newest = aura;
  batch.updates.push_back(aura);
}

void Projection::classify(const Snapshot& snapshot, const InterestMatching& matching) {
  goes_on_ = matching.own().goes_on();
  if (goes_on_) {
    note_busy(matching);
    for (const std::uint32_t i : busy_) classify(i, matching);
    return;
  }
  follow(snapshot);
  busy_.clear();
  for (std::uint32_t i = 0; i < snapshot.bodies.size(); ++i) {
    classify(i, matching);
    if (is_busy(tracks_[i])) busy_.push_back(i);
  }
}

void Projection::classify(std::uint32_t i, const InterestMatching& matching) {
  Track& track = tracks_[i];
  const bool outside = matching.outside(i);
  if (!outside) track.island_since = -1;
  track.audience = matching.audience(i);
  move(track, outside                            ? PhaseEvent::kOutside
              : track.audience != kNobodyListens ? PhaseEvent::kNearBoundary
                                                 : PhaseEvent::kFarFromBoundary);
}

/// Adds the bodies that are near others now, and drops those that no longer project.
void Projection::note_busy(const InterestMatching& matching) {
  std::swap(busy_, were_busy_);
  busy_.clear();
  std::erase_if(were_busy_, [this](std::uint32_t i) { return !is_busy(tracks_[i]); });
  std::ranges::set_union(were_busy_, matching.near_others(), std::back_inserter(busy_));
}

void Projection::publish(const Snapshot& snapshot, AuraBatch& batch, ViolationLog& violations, bool full) {
  projecting_ = 0;
  check_speeds(snapshot, violations);
  for (std::size_t k = 0; k < busy_.size(); ++k) {
    if (k + kPrefetchDistance < busy_.size() && tracks_[busy_[k + kPrefetchDistance]].projected()) {
      prefetch(tracks_[busy_[k + kPrefetchDistance]].published.get(), sizeof(Track::Published));
    }
    Track& track = tracks_[busy_[k]];
    if (track.phase == Phase::kSent) continue;
    const BodyState& body = snapshot.bodies[busy_[k]];
    if (projects(track.phase) && aura_.warns()) {
      ++projecting_;
      check_promise(track, body, snapshot.step, violations);
      check_span(track, body, snapshot.step, violations);
      publish(track, describe(body, track.audience, snapshot.step), batch, full);
    } else if (track.projected()) {
      ++counters_.deleted;
      track.published.reset();
      batch.deletes.push_back(track.id);
    }
  }
  take_back_gone(batch);
  expire_ghosts(snapshot, batch);
  if (!full) return;
  for (const AuraRecord& ghost : ghosts_) {
    if (ghost.stamp < snapshot.step) batch.updates.push_back(ghost);
  }
}

void Projection::depart(const BodyState& body, std::uint32_t i, RegionId destination, PhaseEvent why,
                        AuraBatch& batch) {
  Track& track = tracks_[i];
  move(track, why);
  AuraRecord ghost = describe(body, track.audience, batch.stamp);
  ghost.host = destination;
  ghost.epoch = body.epoch + 1;
  ghost.flags |= kAuraGhost;
  if (!aura_.warns()) return;
  ++(track.projected() ? counters_.updated : counters_.created);
  ghosts_.push_back(ghost);
  batch.updates.push_back(ghost);
}

/// Keeps only the newest ghost of each body. One that came back and left again within 2K steps has two.
void Projection::keep_newest_ghosts() {
  std::sort(ghosts_.begin(), ghosts_.end(),
            [](const AuraRecord& a, const AuraRecord& b) { return a.id != b.id ? a.id < b.id : a.stamp > b.stamp; });
  const auto same = [](const AuraRecord& a, const AuraRecord& b) { return a.id == b.id; };
  ghosts_.erase(std::unique(ghosts_.begin(), ghosts_.end(), same), ghosts_.end());
}

/// A ghost is kept for 2K steps: until the first aura of the new host can have come. A body that came back is no ghost
/// any more.
void Projection::expire_ghosts(const Snapshot& snapshot, AuraBatch& batch) {
  keep_newest_ghosts();
  std::erase_if(ghosts_, [&](const AuraRecord& ghost) {
    const auto here = std::ranges::lower_bound(tracks_, ghost.id, {}, &Track::id);
    if (here != tracks_.end() && here->id == ghost.id && here->phase != Phase::kSent) {
      if (!here->projected()) {
        ++counters_.deleted;
        batch.deletes.push_back(ghost.id);
      }
      return true;
    }
    if (snapshot.step < ghost.stamp + horizon::ghost(aura_.rules().lookahead)) return false;
    ++counters_.deleted;
    batch.deletes.push_back(ghost.id);
    return true;
  });
}

/// Checks a promise after 2K steps. The body has to be on the path of its old aura, with or without the fall, within U
/// v age.
void Projection::check_promise(Track& track, const BodyState& body, Step now, ViolationLog& violations) {
  if (!track.projected() || !aura_.predicts()) return;
  const AuraRecord& promise = track.published->promise;
  const auto age = static_cast<double>(now - promise.stamp);
  if (age < static_cast<double>(horizon::promise(aura_.rules().lookahead))) return;
  Path path = path_of(promise, aura_.clearance());
  const double off = (aura_.ahead(path, age).p_WB - body.pose.p_WB).norm();
  double allowed =
      aura_.rules().contact_margin_m + aura_.rules().uncertainty * promise.speed_m_s * age * aura_.rules().step_s;
  if (off > allowed) {
    path.v_WB = Vec3::Zero();
    allowed += (aura_.ahead(path, age).p_WB - path.pose.p_WB).norm();
  }
  if (off > allowed) violations.add({ViolationKind::kPromise, now, vicinity_.self, body.id, off, allowed});
  track.published->promise = track.published->newest;
}

/// Bodies that have not changed are asleep, so they are not too fast.
void Projection::check_speeds(const Snapshot& snapshot, ViolationLog& violations) {
  const auto check = [&](std::uint32_t i) {
    if (tracks_[i].phase != Phase::kSent) check_speed(tracks_[i], snapshot.bodies[i], snapshot.step, violations);
  };
  if (goes_on_) {
    for (const std::uint32_t i : snapshot.changed) check(i);
  } else {
    for (std::uint32_t i = 0; i < tracks_.size(); ++i) check(i);
  }
}

void Projection::check_speed(Track& track, const BodyState& body, Step now, ViolationLog& violations) {
  const double speed = body.v_WB.norm();
  const bool too_fast = speed > aura_.rules().top_speed_m_s;
  if (too_fast && !track.too_fast) {
    violations.add({ViolationKind::kSpeed, now, vicinity_.self, body.id, speed, aura_.rules().top_speed_m_s});
  } else if (too_fast) {
    violations.still_broken(now);
  }
  track.too_fast = too_fast;
}

/// Counts bodies over regions that do not listen to us: bodies of which we know nothing can hit them there.
void Projection::check_span(Track& track, const BodyState& body, Step now, ViolationLog& violations) {
  const Vec3& p = body.pose.p_WB;
  bool out = false;
  if (!vicinity_.home().contains(p.x(), p.y())) {
    const RegionId over = vicinity_.map.owner(p);
    out = over != vicinity_.self && !vicinity_.is_neighbour(over);
    if (out && !track.out_of_span) {
      violations.add({ViolationKind::kSpan, now, vicinity_.self, body.id,
                      vicinity_.home().distance(vicinity_.map.region(over)), 0});
    }
  }
  track.out_of_span = out;
}

}  // namespace aurasim::core
