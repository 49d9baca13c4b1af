#include "node/collision_watch.h"

#include <algorithm>

namespace aurasim::node {
namespace {

/// Overlaps smaller than this are Bullet's own: contacts are made within its margins (metres).
constexpr double kSlop = 0.02;

/// For so many states after its birth, a body's overlaps are the scene's doing: it appeared there.
constexpr core::Step kYoungSteps = 2;

bool by_id(const std::pair<core::BodyId, core::Step>& a, core::BodyId id) { return a.first < id; }

}  // namespace

void CollisionWatch::newborn(core::BodyId body, core::Step birth) {
  const auto at = std::lower_bound(births_.begin(), births_.end(), body, by_id);
  births_.insert(at, {body, birth});
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

/// A broken promise can spoil what is decided until its messages are replaced: aura, hand-off, and both looks ahead.
bool CollisionWatch::flagged(core::Step step, core::Step last_violation) const {
  return step - last_violation <= 6 * lookahead_ + 2;
}

void CollisionWatch::judge(std::span<const physics::Collision> first_contacts, core::Step last_violation,
                           std::vector<SeenCollision>& out) {
  for (const physics::Collision& c : first_contacts) {
    SeenCollision& seen = out.emplace_back();
    seen.collision = c;
    seen.late = is_late(c);
    seen.flagged = flagged(c.step, last_violation);
    late_ += seen.late;
    unflagged_ += seen.late && !seen.flagged;
  }
}

void CollisionWatch::remember(const core::Snapshot& snapshot, const core::Gathering& gathering) {
  State state{snapshot.step, {}};
  if (states_.size() > static_cast<std::size_t>(2 * lookahead_ + 2)) {
    state.bodies = std::move(states_.front().bodies);
    state.bodies.clear();
    states_.pop_front();
  }
  for (std::uint32_t i = 0; i < snapshot.bodies.size(); ++i) {
    const bool born = snapshot.bodies[i].birth <= snapshot.step;
    if (born && gathering.noticed(i)) state.bodies.push_back({snapshot.bodies[i].id, snapshot.bodies[i].pose});
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

void CollisionWatch::compare(const core::Snapshot& snapshot, const core::Gathering& gathering,
                             core::Step last_violation, std::vector<SeenCollision>& out) {
  remember(snapshot, gathering);
  for (const core::Gathering::Pair& pair : gathering.pairs()) {
    const core::Gathering::Foreign& foreign = gathering.foreign(pair.foreign);
    if (foreign.ghost || !foreign.born) continue;
    const core::Path& own = gathering.path(pair.own);
    const core::Step stamp = snapshot.step - static_cast<core::Step>(foreign.path.age_steps);
    const core::Pose* pose = remembered(stamp, snapshot.bodies[pair.own].id);
    if (!pose) continue;
    const double reach = foreign.path.radius_m + own.radius_m;
    if ((pose->p_WB - foreign.path.pose.p_WB).squaredNorm() > reach * reach) continue;
    const double clearance =
        clearance_.clearance(foreign.path.prototype, foreign.path.pose, own.prototype, *pose, kSlop);
    if (clearance > -kSlop) continue;
    const auto ids = std::minmax(foreign.id, snapshot.bodies[pair.own].id);
    if (!overlapping_.insert(ids).second) continue;
    SeenCollision& seen = out.emplace_back();
    seen.collision = {stamp, ids.first, ids.second, -clearance, (own.v_WB - foreign.path.v_WB).norm(), pose->p_WB};
    seen.missed = true;
    seen.flagged = flagged(stamp, last_violation);
    ++missed_;
    unflagged_ += !seen.flagged;
  }
}

}  // namespace aurasim::node
