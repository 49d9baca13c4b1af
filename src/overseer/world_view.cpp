#include "overseer/world_view.h"

#include <algorithm>
#include <utility>

namespace aurasim::overseer {

using core::BodyId;
using core::RegionId;
using core::Replica;
using core::ReplicaBody;
using core::Step;
using core::value_of;

namespace {

/// Most ticks of one region that wait for another region; beyond this the view goes on without that one.
constexpr std::size_t kMostPending = 64;

}  // namespace

WorldView::WorldView(const ViewSettings& settings) : settings_(settings), sources_(settings.region_count) {}

void WorldView::begin_generation(core::Generation generation) {
  generation_ = generation;
  stamp_ = -1;
  restart_ = true;
  for (Source& source : sources_) {
    source.published = -1;
    source.sequence = 0;
    source.is_whole = false;
    source.pending.clear();
  }
  bodies_.clear();
  slots_.clear();
  free_.clear();
  unclaimed_.clear();
  touched_.clear();
  tombstones_.clear();
}

void WorldView::accept(Replica replica, double now_s) {
  const std::size_t index = value_of(replica.source);
  if (index >= sources_.size() || replica.generation < generation_) return;
  if (sources_[index].state == RegionState::kDead) return;
  if (replica.generation > generation_) begin_generation(replica.generation);
  Source& source = sources_[index];
  // Key frames do not count, because they may have overtaken ticks that are still to come.
  if (!replica.key_frame) source.published = std::max(source.published, replica.stamp);
  const auto later = [](const Replica& a, const Replica& b) {
    return a.stamp != b.stamp ? a.stamp < b.stamp : a.key_frame < b.key_frame;
  };
  const auto place =
      std::upper_bound(source.pending.begin(), source.pending.end(), replica,
                       [&](const Replica& wanted, const Pending& pending) { return later(wanted, pending.replica); });
  source.pending.insert(place, {std::move(replica), now_s});
}

void WorldView::set_region(RegionId region, RegionState state) {
  Source& source = sources_.at(value_of(region));
  if (source.state == state) return;
  const RegionState before = std::exchange(source.state, state);
  if (state == RegionState::kDead) source.pending.clear();
  for (Body& body : bodies_) {
    if (!body.alive || body.host != region || body.under_way) continue;
    if (state == RegionState::kDead) doubt(body, stamp_);
    if (state == RegionState::kLive && before == RegionState::kDead) body.unclaimed_since = -1;
  }
}

bool WorldView::is_ready(Step stamp, double now_s) {
  bool complete = true;
  bool waited_enough = false;
  for (const Source& source : sources_) {
    complete = complete && (source.state != RegionState::kLive || source.published >= stamp);
    waited_enough = waited_enough || source.pending.size() > kMostPending;
    if (!source.pending.empty() && source.pending.front().replica.stamp <= stamp)
      waited_enough = waited_enough || now_s - source.pending.front().came_s >= settings_.wait_s;
  }
  if (!complete && waited_enough) ++counters_.incomplete;
  return complete || waited_enough;
}

const WorldFrame* WorldView::compose(double now_s) {
  while (const std::optional<Step> stamp = oldest_pending()) {
    if (!is_ready(*stamp, now_s)) break;
    const bool is_new = *stamp > stamp_;
    stamp_ = std::max(stamp_, *stamp);
    for (Source& source : sources_) {
      while (!source.pending.empty() && source.pending.front().replica.stamp <= *stamp) {
        const Replica replica = std::move(source.pending.front().replica);
        source.pending.pop_front();
        apply(replica);
      }
    }
    give_up_the_unclaimed();
    if (!is_new && touched_.empty()) continue;  // a late key frame that only confirms what is known
    write_frame();
    return &frame_;
  }
  return nullptr;
}

std::optional<Step> WorldView::oldest_pending() const {
  std::optional<Step> oldest;
  for (const Source& source : sources_) {
    if (source.pending.empty()) continue;
    const Step stamp = source.pending.front().replica.stamp;
    oldest = std::min(oldest.value_or(stamp), stamp);
  }
  return oldest;
}

void WorldView::apply(const Replica& replica) {
  Source& source = sources_[value_of(replica.source)];
  if (!replica.key_frame) {
    if (source.sequence > 0 && replica.sequence > source.sequence + 1)
      counters_.gaps += replica.sequence - source.sequence - 1;
    source.sequence = std::max(source.sequence, replica.sequence);
  }
  for (const ReplicaBody& row : replica.bodies) apply_row(row, replica);
  for (const core::RemovedBody& removed : replica.removed) apply_removal(removed);
  if (!replica.key_frame) return;
  source.is_whole = true;
  doubt_missing(replica);
}

void WorldView::apply_row(const ReplicaBody& row, const Replica& replica) {
  const auto found = slots_.find(row.id);
  if (found == slots_.end()) {
    const auto tombstone = tombstones_.find(row.id);
    if (tombstone == tombstones_.end() || tombstone->second.epoch < row.epoch) create(row, replica);
    return;
  }
  Body& body = bodies_[found->second];
  const bool hosted = row.host == replica.source;
  bool newer = row.epoch > body.epoch;
  // One epoch has one host. A row in which it hosts the body outweighs one that says the body was sent to it.
  if (row.epoch == body.epoch && hosted && row.host == body.host) newer = body.under_way || replica.stamp >= body.stamp;
  if (newer) {
    take_row(body, row, replica);
  } else if (row.epoch == body.epoch && body.under_way) {
    // The sender has confirmed the body up to this state.
    body.unclaimed_since = std::max(body.unclaimed_since, replica.stamp);
  } else {
    ++counters_.stale;
  }
}

void WorldView::take_row(Body& body, const ReplicaBody& row, const Replica& replica) {
  const bool under_way = row.host != replica.source;
  const bool host_changed = row.epoch != body.epoch || row.host != body.host || row.asleep != body.asleep ||
                            under_way != body.under_way || row.prototype != body.prototype;
  const bool moved = row.p_WB != body.p_WB || row.q_WB.coeffs() != body.q_WB.coeffs();
  if (!under_way && (body.under_way || row.host != body.host)) body.handed_over = true;
  body.epoch = row.epoch;
  body.host = row.host;
  body.prototype = row.prototype;
  body.asleep = row.asleep;
  body.under_way = under_way;
  body.p_WB = row.p_WB;
  body.q_WB = row.q_WB;
  body.v_WB = row.v_WB;
  body.w_WB = row.w_WB;
  body.stamp = replica.stamp;
  body.unclaimed_since = -1;
  if (under_way) doubt(body, replica.stamp);
  if (!host_changed && !moved) return;
  touch(body);
  body.host_changed = body.host_changed || host_changed;
  body.moved = body.moved || moved;
}

void WorldView::create(const ReplicaBody& row, const Replica& replica) {
  const Slot slot = free_slot();
  Body& body = bodies_[slot];
  body = {};
  body.slot = slot;
  body.id = row.id;
  body.epoch = row.epoch;
  body.host = row.host;
  body.under_way = row.host != replica.source;
  body.alive = true;
  slots_.emplace(row.id, slot);
  take_row(body, row, replica);
  touch(body);
  body.created = body.host_changed = body.moved = true;
}

void WorldView::apply_removal(const core::RemovedBody& removed) {
  tombstones_.insert_or_assign(removed.id, Tombstone{removed.epoch, stamp_});
  const auto found = slots_.find(removed.id);
  if (found != slots_.end() && bodies_[found->second].epoch <= removed.epoch) erase(bodies_[found->second]);
}

void WorldView::doubt_missing(const Replica& key_frame) {
  for (Body& body : bodies_) {
    if (!body.alive || body.host != key_frame.source || body.under_way || body.stamp >= key_frame.stamp) continue;
    const auto place = std::lower_bound(key_frame.bodies.begin(), key_frame.bodies.end(), body.id,
                                        [](const ReplicaBody& row, BodyId wanted) { return row.id < wanted; });
    const bool named = place != key_frame.bodies.end() && place->id == body.id;
    if (!named) doubt(body, key_frame.stamp);
  }
}

void WorldView::doubt(Body& body, Step since) {
  if (body.unclaimed_since >= 0) return;
  body.unclaimed_since = std::max<Step>(0, since);
  unclaimed_.push_back(body.slot);
}

void WorldView::give_up_the_unclaimed() {
  std::sort(unclaimed_.begin(), unclaimed_.end());
  unclaimed_.erase(std::unique(unclaimed_.begin(), unclaimed_.end()), unclaimed_.end());
  std::erase_if(unclaimed_, [this](Slot slot) {
    Body& body = bodies_[slot];
    if (!body.alive || body.unclaimed_since < 0) return true;
    if (stamp_ - body.unclaimed_since < settings_.unclaimed_patience) return false;
    ++counters_.given_up;
    erase(body);
    return true;
  });
  if (tombstones_.empty()) return;
  std::erase_if(tombstones_,
                [this](const auto& entry) { return stamp_ - entry.second.since > settings_.unclaimed_patience; });
}

void WorldView::erase(Body& body) {
  slots_.erase(body.id);
  touch(body);
  body.alive = false;
}

void WorldView::touch(Body& body) { touched_.push_back(body.slot); }

Slot WorldView::free_slot() {
  if (!free_.empty()) {
    const Slot slot = free_.back();
    free_.pop_back();
    return slot;
  }
  bodies_.emplace_back();
  return static_cast<Slot>(bodies_.size() - 1);
}

void WorldView::write_frame() {
  ++counters_.frames;
  frame_.generation = generation_;
  frame_.stamp = stamp_;
  frame_.restart = std::exchange(restart_, false);
  frame_.deleted.clear();
  frame_.changed.clear();
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  for (const Slot slot : touched_) {
    Body& body = bodies_[slot];
    if (body.alive) {
      frame_.changed.push_back({body, body.created, body.host_changed, body.moved, body.handed_over});
    } else {
      if (!body.created) frame_.deleted.push_back(slot);
      free_.push_back(slot);
    }
    body.created = body.host_changed = body.moved = body.handed_over = false;
  }
  touched_.clear();
}

const ViewBody* WorldView::find(BodyId id) const {
  const auto found = slots_.find(id);
  return found == slots_.end() ? nullptr : &bodies_[found->second];
}

}  // namespace aurasim::overseer
