#include "core/state_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/aura_precision.h"
#include "core/aura_record.h"
#include "core/horizon.h"
#include "core/interest_matching.h"
#include "core/progress.h"

namespace aurasim::core {
namespace {

/// World numbers from here on are for worlds in which clusters make up states; no region has such a number.
constexpr std::uint32_t kFirstLonely = 1U << 31U;

/// Turns the length of a body's way through a step into a speed for the near index. NearIndex::kSlow then separates
/// ways shorter and longer than 0.1 m.
constexpr double kWays_per_s = 30;

/// Sorts by id. Most lists are sorted already, so that is tested first.
template <class Bodies>
void sort_by_id(Bodies& bodies) {
  using Body = typename Bodies::value_type;
  const auto tail = std::ranges::is_sorted_until(bodies, {}, &Body::id);
  std::ranges::stable_sort(tail, bodies.end(), {}, &Body::id);
  std::ranges::inplace_merge(bodies, tail, {}, &Body::id);
}

/// Does a body rest that had path `before` in the state before and has `now`?
bool rests(const Path& before, const Path& now) {
  return !before.moves && !now.moves && before.unborn_steps == 0 && now.unborn_steps == 0 &&
         before.prototype == now.prototype && before.pose.p_WB == now.pose.p_WB &&
         before.pose.q_WB.coeffs() == now.pose.q_WB.coeffs() && before.v_WB == now.v_WB && before.w_WB == now.w_WB;
}

}  // namespace

StateCheck::StateCheck(const Aura& aura, const Vicinity& vicinity, Step start)
    : aura_(aura), motions_(aura), vicinity_(vicinity), checked_(start), whole_(start - 1) {}

StateCheck::State& StateCheck::state(Step step) {
  auto place = std::find_if(states_.begin(), states_.end(), [&](const State& s) { return s.step >= step; });
  if (place != states_.end() && place->step == step) return *place;
  place = states_.insert(place, std::exchange(spare_, {}));
  place->step = step;
  place->own.clear();
  place->others.clear();
  place->top_speed_squared = 0;
  return *place;
}

void StateCheck::add(const AuraRecord& aura, Step step, std::uint32_t world) {
  if (step < checked_ || step <= whole_) return;
  state(step).others.push_back({aura.id, world, path_of(aura, aura_.clearance()), aura.birth <= step});
}

void StateCheck::take(const Neighbour& neighbour) {
  const Step step = neighbour.received();
  for (const AuraRecord& aura : neighbour.auras_arrived()) {
    const bool sleeps = (aura.flags & kAuraAsleep) != 0 && (aura.flags & kAuraGhost) == 0;
    if (aura.stamp == step || (sleeps && aura.stamp < step)) add(aura, step, value_of(neighbour.id()));
  }
  for (const AuraRecord& aura : neighbour.past_arrived()) add(aura, aura.stamp, value_of(neighbour.id()));
}

/// A body that has not changed since some state has the path of the present one in all states from there on. It is
/// stored in none of them, so a sleeper costs nothing.
void StateCheck::take_own(const Snapshot& snapshot, const InterestMatching& matching) {
  matching_ = &matching;
  State& now = state(snapshot.step);
  const OwnBodies& own = matching.own();
  if (own.goes_on()) {
    take_changes(own, now);
  } else {
    take_all(own, now);
  }
  if (used_room_.is_spare(now.own.size() + now.others.size())) free_spare_memory();
}

/// Frees the memory that states with many changes have used. What the lists hold stays.
void StateCheck::free_spare_memory() {
  spare_ = {};
  for (State& state : states_) state.own.shrink_to_fit(), state.others.shrink_to_fit();
  free_memory(noted_before_, own_, others_, middles_);
}

void StateCheck::take_changes(const OwnBodies& own, State& now) {
  for (std::size_t k = 0; k < own.changed().size(); ++k) {
    const std::uint32_t i = own.changed()[k];
    note_before(own.id(i), own.paths_before()[k], noted_[i], now.step);
    note(i, own, now);
  }
}

/// Bodies have come or gone, so each is compared with what it was.
void StateCheck::take_all(const OwnBodies& own, State& now) {
  std::swap(noted_, noted_before_);
  noted_.assign(own.size(), now.step);
  noted_before_.resize(own.ids_before().size(), now.step - 1);
  std::size_t j = 0;
  const auto leave = [&] {
    note_before(own.ids_before()[j], own.paths_before()[j], noted_before_[j], now.step);
    ++j;
  };
  for (std::uint32_t i = 0; i < own.size(); ++i) {
    while (j < own.ids_before().size() && own.ids_before()[j] < own.id(i)) leave();
    const bool was_here = j < own.ids_before().size() && own.ids_before()[j] == own.id(i);
    if (was_here && rests(own.paths_before()[j], own.path(i))) {
      noted_[i] = noted_before_[j++];
      continue;
    }
    if (was_here) leave();
    note(i, own, now);
  }
  while (j < own.ids_before().size()) leave();
}

void StateCheck::add_own(BodyId id, const Path& path, State& to) const {
  to.own.push_back({id, value_of(vicinity_.self), path, path.unborn_steps <= 0});
  to.top_speed_squared = std::max(to.top_speed_squared, path.v_WB.squaredNorm());
}

/// Stores one of our bodies in the present state.
void StateCheck::note(std::uint32_t i, const OwnBodies& own, State& now) {
  add_own(own.id(i), own.path(i), now);
  noted_[i] = now.step;
}

/// Stores the path of a body that has changed in state `now`, or is gone in it, in the earlier states that have the
/// same path: those after `noted`.
void StateCheck::note_before(BodyId id, const Path& before, Step noted, Step now) {
  for (auto state = states_.rbegin(); state != states_.rend() && state->step > noted; ++state) {
    if (state->step >= now) continue;
    add_own(id, before, *state);
  }
}

void StateCheck::take_made_up(const BodyState& body, Step step, std::uint32_t world) {
  if (step < checked_ || step <= whole_) return;
  state(step).others.push_back(
      {body.id, kFirstLonely + world % kFirstLonely, path_of(body, step, aura_.clearance()), body.birth <= step});
}

void StateCheck::take_to_come(const Neighbour& neighbour, std::span<const AuraRecord> to_come) {
  for (const AuraRecord& aura : to_come) add(aura, aura.stamp, value_of(neighbour.id()));
}

void StateCheck::look_at_all(Step now) {
  found_.clear();
  for (; checked_ < now; ++checked_) check(checked_ + 1);
  whole_ = now;
  forget();
}

/// Drops the states that no check needs any more.
void StateCheck::forget() {
  for (; !states_.empty() && states_.front().step < checked_; states_.pop_front()) {
    spare_ = std::move(states_.front());
  }
}

void StateCheck::look(Step now, std::span<const Neighbour> neighbours) {
  found_.clear();
  Step known = now;
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.alive()) known = std::min(known, neighbour.received());
  }
  const Step last = known - horizon::made_up(aura_.rules().lookahead);
  for (; checked_ < last; ++checked_) check(checked_ + 1);
  forget();
}

/// The sphere that holds motion(now, before), without the costly computations.
StateCheck::Way StateCheck::way(const Sighting& now, const Sighting* before) const {
  const double step_s = aura_.rules().step_s;
  const Path& end = now.path;
  Way way{&now, before, end.pose.p_WB, end.radius_m};
  if (!end.moves && (!before || !before->path.moves)) {
    if (before) way.reach_m += (before->path.pose.p_WB - end.pose.p_WB).norm();
    return way;
  }
  const Path& start = before ? before->path : end;
  const double fall_m_s = aura_.rules().gravity.norm() * step_s;
  const double fastest = std::max(start.v_WB.norm(), end.v_WB.norm()) + fall_m_s;
  const Vec3 begin = before ? start.pose.p_WB : end.pose.p_WB - step_s * end.v_WB;
  const double apart = (end.pose.p_WB - begin).norm();
  const double cosine = std::min(1.0, std::abs(start.pose.q_WB.dot(end.pose.q_WB)));
  const double turned = std::numbers::pi * std::sqrt(1 - cosine * cosine) + step_s * start.w_WB.norm();
  const double off = std::max(turned, step_s * (end.w_WB - start.w_WB).norm());
  way.middle = 0.5 * (begin + end.pose.p_WB);
  way.reach_m += 0.5 * apart + bulge(step_s * fastest, apart) + std::min(2.0, off) * end.radius_m;
  if (!before) way.reach_m += step_s * fastest;
  if (aura_.rules().sweeps) way.reach_m += aura_.rules().looks_ahead() ? step_s * fastest : apart;
  return way;
}

/// An upper bound of way().reach_m that needs no square roots of velocities and rotations. `apart`: distance between
/// the body's places at the start and the end of the step; `fastest`: no body is faster at either, m/s.
double StateCheck::reach_at_most(const Path& end, double apart, double fastest) const {
  const double longest = aura_.rules().step_s * (fastest + aura_.rules().gravity.norm() * aura_.rules().step_s);
  return 3 * end.radius_m + 1.5 * apart + 2.5 * longest;
}

/// Calls visit(now, before) for each body of `bodies` that was there while the state was computed. `before` is what it
/// was a state earlier, in `same` or else in `other`; null: it was in neither.
template <class Visit>
void StateCheck::for_each_motion(const std::vector<Sighting>& bodies, const std::vector<Sighting>& same,
                                 const std::vector<Sighting>& other, Visit&& visit) {
  auto old = same.begin();
  for (const Sighting& now : bodies) {
    while (old != same.end() && old->id < now.id) ++old;
    const Sighting* known = old != same.end() && old->id == now.id ? &*old : nullptr;
    if (!known) {  // the body may have changed host, so it is looked up in the other list
      const auto found = std::ranges::lower_bound(other, now.id, {}, &Sighting::id);
      if (found != other.end() && found->id == now.id) known = &*found;
    }
    // A body that appears in this state was not there while it was computed.
    if (now.born && (!known || known->born)) visit(now, known);
  }
}

/// Gathers the bodies of other worlds, and those of ours that may be near one of them.
void StateCheck::gather_ways(const State& before, const State& after) {
  others_.clear();
  for_each_motion(after.others, before.others, before.own,
                  [&](const Sighting& now, const Sighting* known) { others_.push_back(way(now, known)); });
  cover_others();
  own_.clear();
  if (others_.empty()) return;
  const double fastest = std::sqrt(std::max(before.top_speed_squared, after.top_speed_squared));
  const double step_s = aura_.rules().step_s;
  for_each_motion(after.own, before.own, before.others, [&](const Sighting& now, const Sighting* known) {
    const Vec3& end = now.path.pose.p_WB;
    const Vec3 begin = known ? known->path.pose.p_WB : Vec3(end - step_s * now.path.v_WB);
    const double most_m_s = known ? std::max(fastest, known->path.v_WB.norm()) : fastest;
    const double reach = reach_at_most(now.path, (end - begin).norm(), most_m_s);
    if (!covered_.may_meet(0.5 * (begin + end), reach + margin_m_)) return;
    const Way one = way(now, known);
    if (covered_.may_meet(one.middle, one.reach_m + margin_m_)) own_.push_back(one);
  });
}

/// Indexes the bodies of other worlds.
void StateCheck::cover_others() {
  middles_.clear();
  double reach_m = 0;
  for (const Way& way : others_) {
    Path& middle = middles_.emplace_back();
    middle.pose.p_WB = way.middle;
    middle.radius_m = way.now->path.radius_m;
    middle.speed_m_s = kWays_per_s * (way.reach_m - middle.radius_m);
    reach_m += way.reach_m;
  }
  near_.build(middles_);
  margin_m_ = aura_.rules().contact_margin_m + 2 * rounded_within_m(near_.top_radius());
  covered_.clear(std::max(4 * reach_m / static_cast<double>(std::max<std::size_t>(1, others_.size())), 1e-3));
  for (const Way& way : others_) covered_.add(way.middle, way.reach_m);
}

/// May the bodies of two ways have touched during the step?
bool StateCheck::touch(const Way& a, const Way& b) const {
  const auto motion = [this](const Way& way) {
    return motions_.of(way.now->path, way.before ? &way.before->path : nullptr);
  };
  return motions_.touch(motion(a), motion(b));
}

/// Compares `one` with the ways in others_ from index `from` on.
void StateCheck::compare_with_others(const Way& one, std::uint32_t from) {
  Progress::mark();
  const double range = margin_m_ + one.reach_m;
  const auto range_at = [&](double speed_m_s) { return range + speed_m_s / kWays_per_s; };
  near_.for_each_near(one.middle, 0, range_at, [&](std::uint32_t i) {
    const Way& other = others_[i];
    if (i < from || other.now->world == one.now->world || other.now->id == one.now->id) return;
    const double apart = range + other.reach_m;
    if ((one.middle - other.middle).squaredNorm() > apart * apart) return;
    if (!touch(one, other)) return;
    const auto [a, b] = std::minmax(one.now->id, other.now->id);
    found_.push_back({0, step_, a, b});
  });
}

/// Compares `other` with our bodies that have not changed since the state before.
void StateCheck::compare_with_resting(const Way& other) {
  Progress::mark();
  const double range = margin_m_ + other.reach_m;
  matching_->clusters().near().for_each_near(
      other.middle, 0, [range](double) { return range; },
      [&](std::uint32_t i) {
        const Path& path = matching_->path(i);
        const double apart = range + path.radius_m;
        if (noted_[i] >= step_ || (path.pose.p_WB - other.middle).squaredNorm() > apart * apart) return;
        const Sighting one{matching_->id(i), value_of(vicinity_.self), path, true};
        if (one.id == other.now->id || !touch({&one, &one}, other)) return;
        const auto [a, b] = std::minmax(one.id, other.now->id);
        found_.push_back({0, step_, a, b});
      });
}

void StateCheck::check(Step step) {
  state(step);  // inserts both states first, because an insertion below would invalidate a reference
  State& before = state(step - 1);
  State& after = state(step);
  for (State* each : {&before, &after}) {
    sort_by_id(each->own);
    sort_by_id(each->others);
  }
  if (after.others.empty()) return;
  step_ = step;
  gather_ways(before, after);
  for (const Way& way : own_) compare_with_others(way, 0);
  if (std::ranges::any_of(noted_, [step](Step noted) { return noted < step; })) {
    for (const Way& way : others_) compare_with_resting(way);
  }
  std::ranges::sort(found_, {}, [](const Alarm& alarm) { return std::tuple(alarm.step, alarm.a, alarm.b); });
  compare_guests();
}

/// Compares bodies of other worlds with each other. One that is over its host's region is left to that host, to which
/// whatever may touch it there is announced, too (docs/design.md, "To whom an aura goes").
void StateCheck::compare_guests() {
  std::erase_if(others_, [this](const Way& way) {
    const Vec3& p = way.now->path.pose.p_WB;
    return way.now->world < kFirstLonely && vicinity_.map.region(RegionId{way.now->world}).contains(p.x(), p.y());
  });
  const bool several =
      std::ranges::any_of(others_, [this](const Way& way) { return way.now->world != others_.front().now->world; });
  if (!several) return;
  cover_others();
  for (std::uint32_t i = 0; i < others_.size(); ++i) compare_with_others(others_[i], i + 1);
}

}  // namespace aurasim::core
