#include "agent/observer.h"

#include <algorithm>
#include <utility>

namespace aurasim::agent {
namespace {

/// Limit of states that wait for the client; the oldest are dropped.
constexpr std::size_t kMostReady = 256;

/// Time to wait for scene orders, seconds. Later ones, such as those of a missing mesh, are not waited for.
constexpr double kPatienceWithScene_s = 1;

core::WorldBox around(const core::WorldBox& box, double margin_m) {
  const core::Vec3 margin = core::Vec3::Constant(margin_m);
  return {box.low - margin, box.high + margin};
}

template <class T>
void add_if_new(std::vector<T>& ascending, const T& value) {
  const auto place = std::ranges::lower_bound(ascending, value);
  if (place == ascending.end() || *place != value) ascending.insert(place, value);
}

}  // namespace

Observer::Observer(dds::Participant& participant, const overseer::WorldWatch& watch, AskedInterest asked)
    : watch_(watch),
      asked_(std::move(asked)),
      endpoint_(participant, watch.observer_settings()),
      states_({.latest_steps = 2 * watch.launch().lookahead() + 2}) {
  if (!asked_.fans.empty()) scene_.emplace(participant, watch);
  for (const FanSpec& fan : asked_.fans) {
    surroundings_.emplace_back(fan.mount, fan.range_m + scene_->rays().largest_radius_m());
  }
  for (const TriggerSpec& trigger : asked_.triggers) {
    surroundings_.emplace_back(trigger.mount, trigger.reach_m());
    triggers_.emplace_back(trigger);
  }
  // The view has the approximate places of carriers.
  watch_.view().for_each([this](const overseer::ViewBody& body) {
    for (Surroundings& around_it : surroundings_) {
      if (around_it.mount().carrier == body.id) around_it.follow(body.p_WB, around_it.reach_m());
    }
  });
  want();
}

/// Sends the interest: the client's selection, and the boxes that its sensors need.
void Observer::want() {
  core::Interest interest = asked_.selection;
  for (const Surroundings& around_it : surroundings_) {
    if (around_it.mount().carrier) add_if_new(interest.bodies, *around_it.mount().carrier);
    if (const std::optional<core::WorldBox> box = around_it.box()) interest.boxes.push_back(*box);
  }
  const std::uint64_t sequence = endpoint_.want(std::move(interest));
  for (Surroundings& around_it : surroundings_) around_it.note(sequence);
}

void Observer::turn(const std::set<core::RegionId>& regions) {
  endpoint_.use(watch_.observer_settings());
  if (scene_) scene_->look();
  const double now_s = overseer::view_clock_s();
  for (core::Observation& observation : endpoint_.take()) states_.accept(std::move(observation), now_s);
  for (MergedState& state : states_.take(regions, now_s)) {
    look_around(state);
    whole_.push_back({std::move(state), now_s});
  }
  sense_what_is_known(now_s);
}

/// Evaluates sensors of the states whose scene is known. Rays need the places of statics that orders have moved, which
/// come over another topic than bodies.
void Observer::sense_what_is_known(double now_s) {
  while (!whole_.empty()) {
    Whole& oldest = whole_.front();
    const bool is_known = !scene_ || scene_->has_all_up_to(oldest.state.scene_order);
    if (!is_known && now_s - oldest.since_s < kPatienceWithScene_s) return;
    const std::uint64_t left_out = states_left_out_before(oldest.state);
    ready_.push_back(sense(std::move(oldest.state)));
    ready_.back().skipped = left_out;
    whole_.pop_front();
    if (ready_.size() <= kMostReady) continue;
    skipped_ += ready_.front().skipped + 1;
    ready_.pop_front();
  }
}

/// Number of states that nodes have left out before this one, because this process or the client was too slow.
std::uint64_t Observer::states_left_out_before(const MergedState& state) {
  const Place place{state.generation, state.redo, state.step};
  const Place last = std::exchange(last_, place);
  const core::Step every = asked_.selection.every;
  const bool goes_on = last.generation == place.generation && last.redo == place.redo && place.step > last.step;
  if (every == 0 || last.step < 0 || !goes_on) return 0;
  return static_cast<std::uint64_t>((place.step - 1) / every - last.step / every);
}

std::optional<Observed> Observer::next() {
  if (ready_.empty()) return std::nullopt;
  Observed oldest = std::move(ready_.front());
  ready_.pop_front();
  oldest.skipped += std::exchange(skipped_, 0);
  return oldest;
}

/// Sends a new interest if a sensor has moved out of its box.
void Observer::look_around(const MergedState& state) {
  bool has_moved = false;
  for (std::size_t i = 0; i < surroundings_.size(); ++i) {
    const std::optional<core::Pose> X_WS = surroundings_[i].mount().pose_in(state.bodies);
    if (!X_WS) continue;
    const bool is_fan = i < asked_.fans.size();
    const double reach = is_fan ? asked_.fans[i].range_m + scene_->rays().largest_radius_m()
                                : asked_.triggers[i - asked_.fans.size()].reach_m();
    has_moved = surroundings_[i].follow(X_WS->p_WB, reach) || has_moved;
  }
  if (has_moved) want();
}

/// True if no body within reach is missing, and all within reach was asked for.
bool Observer::is_known(const Surroundings& around_it, const MergedState& state) const {
  const std::optional<core::Pose> X_WS = around_it.mount().pose_in(state.bodies);
  if (!X_WS || !state.silent.empty() || !around_it.was_asked_for(state.sequence, X_WS->p_WB)) return false;
  const std::optional<core::WorldBox> box = around_it.box();
  // A missing body has moved for a state or two at most, so a margin is enough.
  return std::ranges::none_of(state.bodies, [&](const WorldBody& body) {
    return std::ranges::binary_search(state.missing, body.row.id) && around(*box, 10).holds(body.row.p_WB);
  });
}

FanResult Observer::cast(std::size_t i, const MergedState& state) const {
  const FanSpec& fan = asked_.fans[i];
  FanResult result;
  const std::optional<core::Pose> X_WS = fan.mount.pose_in(state.bodies);
  if (state.step % fan.every != 0 || !X_WS) return result;
  std::vector<physics::PlacedBody> bodies;
  bool knows_all = scene_->has_all_up_to(state.scene_order);
  for (const WorldBody& body : state.bodies) {
    knows_all = knows_all && core::value_of(body.row.prototype) < scene_->prototypes();
    bodies.push_back({body.row.id, body.row.prototype, {body.row.p_WB, body.row.q_WB.cast<double>()}});
  }
  result.was_cast = true;
  result.complete = knows_all && is_known(surroundings_[i], state);
  result.hits = scene_->rays().cast(state.step, bodies, {*X_WS, fan.directions, fan.range_m, fan.mount.carrier});
  return result;
}

Observed Observer::sense(MergedState state) {
  Observed observed;
  for (std::size_t i = 0; i < asked_.fans.size(); ++i) observed.fans.push_back(cast(i, state));
  for (std::size_t i = 0; i < triggers_.size(); ++i) {
    observed.triggers.push_back(triggers_[i].look(state.bodies));
    TriggerResult& result = observed.triggers.back();
    result.complete = result.complete && is_known(surroundings_[asked_.fans.size() + i], state);
  }
  keep_what_is_wanted(state);
  observed.state = std::move(state);
  return observed;
}

/// Removes the bodies that only the sensors need.
void Observer::keep_what_is_wanted(MergedState& state) const {
  const core::Interest& selection = asked_.selection;
  if (selection.all || surroundings_.empty()) return;
  std::set<core::ObjectRef> wanted;
  const auto is_wanted = [&](const WorldBody& body) {
    return selection.wants(body.row.id, body.row.prototype, body.row.p_WB);
  };
  std::erase_if(state.bodies, [&](const WorldBody& body) {
    if (!is_wanted(body)) return true;
    wanted.insert(core::ref_of(body.row.id));
    return false;
  });
  std::erase_if(state.contacts, [&](const core::ContactImpulse& contact) {
    return !wanted.contains(contact.a) && !wanted.contains(contact.b);
  });
  const std::vector<core::JointSpec>& joints = watch_.launch().scene.joints;
  std::erase_if(state.joints, [&](const core::JointState& joint) {
    if (core::value_of(joint.id) >= joints.size()) return true;
    const core::JointSpec& spec = joints[core::value_of(joint.id)];
    return !wanted.contains(core::ref_of(spec.a)) && !(spec.b && wanted.contains(core::ref_of(*spec.b)));
  });
}

}  // namespace aurasim::agent
