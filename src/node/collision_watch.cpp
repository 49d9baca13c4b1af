#include "node/collision_watch.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "core/horizon.h"

namespace aurasim::node {
namespace {

/// Overlaps below this many metres do not count: Bullet makes contacts within its margins.
constexpr double kSlop = 0.02;

/// Number of states after its birth in which a body's overlaps do not count, because the scene made it appear there.
constexpr core::Step kYoungSteps = 2;

bool touch(const core::Snapshot& snapshot, std::uint32_t i, std::uint32_t j) {
  const auto [a, b] = std::minmax(i, j);
  return std::binary_search(
      snapshot.contacts.begin(), snapshot.contacts.end(), core::Contact{a, b},
      [](const core::Contact& x, const core::Contact& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
}

bool stands_still(const core::Path& path) { return path.v_WB.isZero(0) && path.w_WB.isZero(0); }

bool by_id(const std::pair<core::BodyId, core::Step>& a, core::BodyId id) { return a.first < id; }

}  // namespace

void CollisionWatch::newborn(core::BodyId body, core::Step birth) {
  const auto at = std::lower_bound(births_.begin(), births_.end(), body, by_id);
  births_.insert(at, {body, birth});
}

void CollisionWatch::forget_grown_up(core::Step now) {
  std::erase_if(births_, [now](const auto& birth) { return now > birth.second + kYoungSteps; });
}

bool CollisionWatch::was_just_born(const physics::Collision& c) const {
  const auto young = [&](core::BodyId id) {
    const auto found = std::lower_bound(births_.begin(), births_.end(), id, by_id);
    return found != births_.end() && found->first == id && c.step <= found->second + kYoungSteps;
  };
  return c.step <= kYoungSteps || young(c.a) || young(c.b);
}

bool CollisionWatch::is_late(const physics::Collision& c) const {
  const double one_step = (c.relative_speed_m_s + gravity_m_s2_ * step_s_) * step_s_;
  return c.penetration_m > one_step + kSlop && !was_just_born(c);
}

bool CollisionWatch::flagged(core::Step step, core::Step last_violation) const {
  return step - last_violation <= core::horizon::blame(lookahead_);
}

void CollisionWatch::judge(std::span<const physics::Collision> first_contacts, core::Step last_violation,
                           std::vector<SeenCollision>& out) {
  sort_joined();
  for (const physics::Collision& c : first_contacts) {
    const bool judged_before = untouching_.erase({c.a, c.b}) > 0;
    report({c, !judged_before && met_here(c) && is_late(c)}, last_violation, out);
  }
}

/// True if the two bodies came into one world in this state or the one before. Bodies that have been in one world for
/// longer collide as in a single world, however deep they overlap: a thing that breaks or appears may put one into the
/// other. Bodies that joined for the last state are included, because Bullet may find their contact only in this state.
bool CollisionWatch::met_here(const physics::Collision& c) const {
  const auto came = [&](const std::vector<Joined>& joined) {
    return (find(joined, c.a) || find(joined, c.b)) && !came_together({c.a, c.b}, joined);
  };
  return came(joined_) || came(joined_before_);
}

void CollisionWatch::sort_joined() { std::ranges::sort(joined_, {}, &Joined::id); }

void CollisionWatch::report(SeenCollision seen, core::Step last_violation, std::vector<SeenCollision>& out) {
  seen.flagged = flagged(seen.collision.step, last_violation);
  counts_.late += seen.late;
  counts_.missed += seen.missed;
  counts_.unflagged += (seen.late || seen.missed) && !seen.flagged;
  out.push_back(seen);
}

void CollisionWatch::put_back(const CollisionCounts& counts) {
  counts_ = counts;
  states_.clear();
  overlapping_.clear();
  joined_.clear();
  joined_before_.clear();
  untouching_.clear();
}

void CollisionWatch::join(const core::Adoption& adoption) {
  for (const core::BodyRecord& body : adoption.cluster.bodies) {
    joined_.push_back({body.id, adoption.source, adoption.stamp});
    if (body.birth > 0) newborn(body.id, body.birth);
  }
}

const CollisionWatch::Joined* CollisionWatch::find(const std::vector<Joined>& joined, core::BodyId id) {
  const auto found = std::ranges::lower_bound(joined, id, {}, &Joined::id);
  return found != joined.end() && found->id == id ? &*found : nullptr;
}

/// True if both bodies came in one hand-off. They were in one world before, where their contacts have been judged.
bool CollisionWatch::came_together(const Pair& pair, const std::vector<Joined>& joined) {
  const Joined* const first = find(joined, pair.first);
  const Joined* const second = find(joined, pair.second);
  return first && second && first->source == second->source && first->stamp == second->stamp;
}

/// Forgets pairs of which a body has left, even if it has come back: it may have moved meanwhile.
void CollisionWatch::forget_parted(const core::OwnBodies& own) {
  const auto stays = [&](core::BodyId id) { return own.find(id) && !find(joined_, id); };
  std::erase_if(untouching_, [&](const Pair& pair) { return !stays(pair.first) || !stays(pair.second); });
}

/// The overlap of two bodies that Bullet will not look at. Empty if they touch, or if one moves, because then Bullet
/// checks them in the next step. Motion decides, not sleep: a sleeping body that will get an impulse already counts as
/// awake.
std::optional<SeenCollision> CollisionWatch::overlap_of(std::uint32_t i, std::uint32_t j,
                                                        const core::Snapshot& snapshot,
                                                        const core::InterestMatching& matching) const {
  const core::Path& a = matching.path(i);
  const core::Path& b = matching.path(j);
  if (!stands_still(a) || !stands_still(b) || touch(snapshot, i, j)) return std::nullopt;
  if ((a.pose.p_WB - b.pose.p_WB).norm() > a.radius_m + b.radius_m) return std::nullopt;
  const double clearance = clearance_.clearance(a.prototype, a.pose, b.prototype, b.pose, kSlop);
  const auto [first, second] = std::minmax(snapshot.bodies[i].id, snapshot.bodies[j].id);
  SeenCollision seen;
  seen.collision = {snapshot.step, first, second, -clearance, 0, a.pose.p_WB};
  seen.late = is_late(seen.collision);
  return seen.late ? std::optional(seen) : std::nullopt;
}

void CollisionWatch::judge_arrivals(const core::Snapshot& snapshot, const core::InterestMatching& matching,
                                    core::Step last_violation, std::vector<SeenCollision>& out) {
  sort_joined();
  forget_parted(matching.own());
  for (const Joined& arrival : joined_) {
    const std::optional<std::uint32_t> here = matching.own().find(arrival.id);
    if (!here) continue;
    const core::Path& path = matching.path(*here);
    matching.clusters().near().for_each_near(
        path.pose.p_WB, path.radius_m, [](double) { return 0.0; },
        [&](std::uint32_t other) {
          if (other == *here) return;
          std::optional<SeenCollision> seen = overlap_of(*here, other, snapshot, matching);
          if (!seen || !untouching_.insert({seen->collision.a, seen->collision.b}).second) return;
          if (!came_together({seen->collision.a, seen->collision.b}, joined_)) report(*seen, last_violation, out);
        });
  }
  joined_before_.swap(joined_);
  joined_.clear();
}

void CollisionWatch::remember(const core::Snapshot& snapshot, const core::InterestMatching& matching) {
  State state{snapshot.step, {}};
  if (states_.size() > static_cast<std::size_t>(core::horizon::under_way(lookahead_))) {
    state.bodies = std::move(states_.front().bodies);
    state.bodies.clear();
    states_.pop_front();
  }
  for (const std::uint32_t i : matching.near_others()) {
    const bool born = snapshot.bodies[i].birth <= snapshot.step;
    if (born) state.bodies.push_back({snapshot.bodies[i].id, snapshot.bodies[i].pose});
  }
  states_.push_back(std::move(state));
}

const core::Pose* CollisionWatch::remembered(core::Step step, core::BodyId id) const {
  for (const State& state : states_) {
    if (state.step != step) continue;
    const auto found = std::lower_bound(state.bodies.begin(), state.bodies.end(), id,
                                        [](const Remembered& r, core::BodyId x) { return r.id < x; });
    return found != state.bodies.end() && found->id == id ? &found->pose : nullptr;
  }
  return nullptr;
}

/// Forgets pairs that have not been seen to overlap for longer than an aura may be old. They are apart and may meet
/// again.
void CollisionWatch::forget_separated(core::Step now) {
  std::erase_if(overlapping_,
                [&](const auto& pair) { return now - pair.second > 2 * core::horizon::under_way(lookahead_); });
}

void CollisionWatch::compare(const core::Snapshot& snapshot, const core::InterestMatching& matching,
                             core::Step last_violation, std::vector<SeenCollision>& out) {
  remember(snapshot, matching);
  forget_separated(snapshot.step);
  forget_grown_up(snapshot.step);
  for (const core::InterestMatching::Pair& pair : matching.pairs()) {
    const core::Foreign& foreign = matching.foreign(pair.foreign);
    if (foreign.ghost || !foreign.born) continue;
    const core::Path& own = matching.path(pair.own);
    const core::Step stamp = snapshot.step - static_cast<core::Step>(foreign.path.age_steps);
    const core::Pose* pose = remembered(stamp, snapshot.bodies[pair.own].id);
    if (!pose) continue;
    const double reach = foreign.path.radius_m + own.radius_m;
    if ((pose->p_WB - foreign.path.pose.p_WB).squaredNorm() > reach * reach) continue;
    const double clearance =
        clearance_.clearance(foreign.path.prototype, foreign.path.pose, own.prototype, *pose, kSlop);
    if (clearance > -kSlop) continue;
    const auto ids = std::minmax(foreign.id, snapshot.bodies[pair.own].id);
    const auto [counted, is_new] = overlapping_.try_emplace(ids, stamp);
    counted->second = stamp;
    if (!is_new) continue;
    SeenCollision seen;
    seen.collision = {stamp, ids.first, ids.second, -clearance, (own.v_WB - foreign.path.v_WB).norm(), pose->p_WB};
    seen.missed = true;
    report(seen, last_violation, out);
  }
}

}  // namespace aurasim::node
