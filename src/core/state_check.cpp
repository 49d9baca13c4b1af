#include "core/state_check.h"

#include <algorithm>
#include <cmath>

#include "core/aura_precision.h"
#include "core/horizon.h"
#include "core/interest_matching.h"

namespace aurasim::core {
namespace {

/// Worlds of clusters that make up states alone: no region has such a number.
constexpr std::uint32_t kFirstLonely = 1U << 31U;

/// How far a way of at most `longest` between two points `apart` from each other can leave the straight line.
double bulge(double longest, double apart) {
  return longest > apart ? 0.5 * std::sqrt(longest * longest - apart * apart) : 0;
}

}  // namespace

StateCheck::StateCheck(const Aura& aura, const Vicinity& vicinity, Step start)
    : aura_(aura), vicinity_(vicinity), start_(start), checked_(start) {}

StateCheck::State& StateCheck::state(Step step) {
  auto place = std::find_if(states_.begin(), states_.end(), [&](const State& s) { return s.step >= step; });
  if (place == states_.end() || place->step != step) place = states_.insert(place, State{step, {}});
  return *place;
}

void StateCheck::add(const AuraRecord& aura, Step step, std::uint32_t world) {
  if (aura.birth > step || step < checked_) return;
  Sighting& seen = state(step).bodies.emplace_back();
  seen.id = aura.id;
  seen.world = world;
  seen.path.prototype = aura.prototype;
  seen.path.radius_m = aura_.clearance().bounding_radius(aura.prototype);
  seen.path.pose = aura.pose;
  seen.path.v_WB = aura.v_WB;
  seen.path.w_WB = aura.w_WB;
  seen.path.moves = (aura.flags & kAuraAsleep) == 0;
  seen.path.blur_m = rounded_within_m(seen.path.radius_m);
}

void StateCheck::take(const Neighbour& neighbour) {
  const Step step = neighbour.applied();
  for (const AuraRecord& aura : neighbour.auras()) {
    const bool sleeps = (aura.flags & kAuraAsleep) != 0 && (aura.flags & kAuraGhost) == 0;
    if (aura.stamp == step || (sleeps && aura.stamp < step)) add(aura, step, value_of(neighbour.id()));
  }
  for (const AuraRecord& aura : neighbour.past()) add(aura, aura.stamp, value_of(neighbour.id()));
}

void StateCheck::take_own(const Snapshot& snapshot, const InterestMatching& matching) {
  State& now = state(snapshot.step);
  for (std::uint32_t i = 0; i < snapshot.bodies.size(); ++i) {
    const BodyState& body = snapshot.bodies[i];
    if (body.birth > snapshot.step) continue;
    if (!matching.outside(i) && !matching.must_be_announced(i)) continue;
    now.bodies.push_back({body.id, value_of(vicinity_.self), path_of(body, snapshot.step, aura_.clearance())});
  }
}

void StateCheck::take_made_up(const BodyState& body, Step step, std::uint32_t nth) {
  if (step < checked_) return;
  state(step).bodies.push_back({body.id, kFirstLonely + nth, path_of(body, step, aura_.clearance())});
}

void StateCheck::look(Step now, std::span<const Neighbour> neighbours) {
  found_.clear();
  const int lookahead = aura_.rules().lookahead;
  Step known = now;
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.alive()) known = std::min(known, neighbour.applied());
  }
  const Step last = std::min(now - horizon::check(lookahead), known - (lookahead - 1));
  for (; checked_ < last; ++checked_) check(checked_ + 1);
  while (!states_.empty() && states_.front().step < checked_) states_.pop_front();
}

/// A body that has just begun to be announced was far from everybody else's a state ago: it came straight, more or
/// less.
StateCheck::Motion StateCheck::motion(const Sighting& now, const Sighting* before) const {
  const double step_s = aura_.rules().step_s;
  Motion motion{now.id, now.world, now.path, now.path, 0};
  const double fall_m_s = aura_.rules().gravity.norm() * step_s;
  if (before) {
    motion.at_start = before->path;
  } else if (now.path.moves) {
    motion.at_start.pose.p_WB -= step_s * now.path.v_WB;
    motion.stray_m = step_s * (now.path.v_WB.norm() + fall_m_s);
  }
  const Path& start = motion.at_start;
  if (!start.moves && !now.path.moves) return motion;
  const double fastest = std::max(start.v_WB.norm(), now.path.v_WB.norm()) + fall_m_s;
  motion.stray_m += bulge(step_s * fastest, (now.path.pose.p_WB - start.pose.p_WB).norm());
  const Quat turned = pose(motion, 1).q_WB;
  const double off = std::max(turned.angularDistance(now.path.pose.q_WB), step_s * (now.path.w_WB - start.w_WB).norm());
  motion.stray_m += std::min(2.0, off) * now.path.radius_m;
  return motion;
}

/// When `share` of the step is over, 0 to 1: straight ahead, turning as it did at the start.
Pose StateCheck::pose(const Motion& motion, double share) const {
  const Pose& from = motion.at_start.pose;
  Pose pose{from.p_WB + share * (motion.at_end.pose.p_WB - from.p_WB), from.q_WB};
  const double spin = motion.at_start.w_WB.norm();
  if (motion.at_start.moves && spin > 1e-6) {
    const double angle = spin * share * aura_.rules().step_s;
    pose.q_WB = Quat(Eigen::AngleAxisd(angle, motion.at_start.w_WB / spin)) * from.q_WB;
  }
  return pose;
}

void StateCheck::gather_motions(State& before, State& after) {
  for (State* state : {&before, &after}) std::ranges::stable_sort(state->bodies, {}, &Sighting::id);
  motions_.clear();
  middles_.clear();
  auto old = before.bodies.begin();
  for (const Sighting& now : after.bodies) {
    while (old != before.bodies.end() && old->id < now.id) ++old;
    const bool known = old != before.bodies.end() && old->id == now.id;
    const Motion& motion = motions_.emplace_back(this->motion(now, known ? &*old : nullptr));
    Path& middle = middles_.emplace_back(now.path);
    middle.pose = pose(motion, 0.5);
    // Half of the way, as the speed at which it would be covered in one second.
    middle.speed_m_s = 0.5 * (now.path.pose.p_WB - motion.at_start.pose.p_WB).norm() + motion.stray_m;
  }
  near_.build(middles_);
}

/// Physics moves a body ahead by a substep and looks what is in its way: where that was, or already is after the
/// substep.
bool StateCheck::sweeps_into(const Motion& moving, const Motion& other, double share, double allowed_m) const {
  if (!moving.at_end.moves && !moving.at_start.moves) return false;
  const double half = 0.5 / aura_.rules().substeps;
  const double way = (moving.at_end.pose.p_WB - moving.at_start.pose.p_WB).norm() * half +
                     (other.at_end.pose.p_WB - other.at_start.pose.p_WB).norm() * 2 * half;
  const Pose middle = pose(moving, share + half);
  const Pose at = pose(other, share);
  const double allowed = allowed_m + way + moving.stray_m + other.stray_m;
  if ((middle.p_WB - at.p_WB).norm() - moving.at_end.radius_m - other.at_end.radius_m > allowed) return false;
  return aura_.clearance().clearance(moving.at_end.prototype, middle, other.at_end.prototype, at, allowed) <= allowed;
}

/// Contacts are looked for at the start of each substep.
bool StateCheck::touch(const Motion& a, const Motion& b) const {
  const int substeps = aura_.rules().substeps;
  const double margin = aura_.rules().contact_margin_m * aura_.rules().check_scale;
  for (int i = 0; i < substeps; ++i) {
    const double share = static_cast<double>(i) / substeps;
    const double allowed = margin + a.at_end.blur_m + b.at_end.blur_m + (i > 0 ? a.stray_m + b.stray_m : 0);
    if (aura_.rules().sweeps && (sweeps_into(a, b, share, allowed) || sweeps_into(b, a, share, allowed))) return true;
    const Pose at = pose(a, share);
    const Pose bt = pose(b, share);
    const double gap = (at.p_WB - bt.p_WB).norm() - a.at_end.radius_m - b.at_end.radius_m;
    if (gap > allowed) continue;
    if (aura_.clearance().clearance(a.at_end.prototype, at, b.at_end.prototype, bt, allowed) <= allowed) return true;
  }
  return false;
}

void StateCheck::check(Step step) {
  gather_motions(state(step - 1), state(step));
  const double margin = aura_.rules().contact_margin_m + 2 * rounded_within_m(near_.top_radius()) +
                        (aura_.rules().sweeps ? 2 * near_.top_speed() : 0);
  const double fastest = near_.top_speed();
  for (std::uint32_t i = 0; i < motions_.size(); ++i) {
    const Motion& one = motions_[i];
    if (one.world == value_of(vicinity_.self)) continue;
    const double range = margin + middles_[i].speed_m_s;
    const Vec3& p = middles_[i].pose.p_WB;
    near_.for_each_near(p, middles_[i].radius_m, range + std::min(fastest, NearIndex::kSlow), range + fastest,
                        [&](std::uint32_t j) {
                          const Motion& other = motions_[j];
                          if (other.world == one.world || other.id == one.id) return;
                          if (other.world != value_of(vicinity_.self) && j < i) return;  // seen the other way round
                          if (!touch(one, other)) return;
                          const auto [a, b] = std::minmax(one.id, other.id);
                          found_.push_back({0, step, a, b});
                        });
  }
}

}  // namespace aurasim::core
