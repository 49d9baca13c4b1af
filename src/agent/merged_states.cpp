#include "agent/merged_states.h"

#include <algorithm>
#include <utility>

namespace aurasim::agent {
namespace {

/// Limit of states that wait; the oldest are dropped.
constexpr std::size_t kMostPending = 4096;
/// Limit of states that wait before the first whole state, for which they may wait without a time limit.
constexpr std::size_t kMostBeforeTheFirst = 256;

Observations all_of(const std::map<core::RegionId, core::Observation>& hosted,
                    const std::vector<core::Observation>& made_up) {
  Observations all;
  for (const auto& [source, observation] : hosted) all.push_back(&observation);
  for (const core::Observation& observation : made_up) all.push_back(&observation);
  return all;
}

}  // namespace

void MergedStates::begin_generation(core::Generation generation) {
  generation_ = generation;
  redo_ = 0;
  given_ = -1;
  has_given_ = false;
  pending_.clear();
  told_.clear();
  left_out_.clear();
}

/// Drops the observations of `to` and later states from before the redo.
void MergedStates::go_back(core::Step to, std::uint32_t redo) {
  std::erase_if(pending_, [&](const auto& entry) { return entry.first >= to && entry.second.redo < redo; });
  for (auto& [region, step] : told_) step = std::min(step, to - 1);
  given_ = std::min(given_, to - 1);
  left_out_.clear();
  redo_ = redo;
}

void MergedStates::accept(core::Observation observation, double now_s) {
  if (generation_ && observation.generation < *generation_) return;
  if (!generation_ || observation.generation > *generation_) begin_generation(observation.generation);
  const bool is_hosted = observation.kind == core::Observation::Kind::kHosted;
  if (is_hosted && observation.redo > redo_) go_back(observation.stamp, observation.redo);
  if (observation.stamp <= given_) return;
  Pending& pending = pending_.try_emplace(observation.stamp, Pending{observation.redo, now_s, {}, {}}).first->second;
  if (observation.redo < pending.redo) return;
  if (observation.redo > pending.redo) pending = {observation.redo, now_s, {}, {}};
  if (is_hosted) {
    core::Step& told = told_.try_emplace(observation.source, observation.stamp).first->second;
    told = std::max(told, observation.stamp);
    if (observation.previous >= 0 && observation.previous + 1 < observation.stamp) {
      left_out_.push_back({observation.source, observation.previous + 1, observation.stamp - 1});
    }
    pending.hosted.insert_or_assign(observation.source, std::move(observation));
  } else {
    pending.made_up.push_back(std::move(observation));
  }
  if (pending_.size() > (has_given_ ? kMostPending : kMostBeforeTheFirst)) pending_.erase(pending_.begin());
}

/// True if a region has left this state out, so that it will never be whole.
bool MergedStates::is_left_out(core::Step step, const Pending& pending) const {
  return std::ranges::any_of(left_out_, [&](const LeftOut& states) {
    return states.first <= step && step <= states.last && !pending.hosted.contains(states.source);
  });
}

bool MergedStates::have_passed(core::Step step, const std::set<core::RegionId>& regions) const {
  return std::ranges::all_of(regions, [&](core::RegionId region) {
    const auto told = told_.find(region);
    return told != told_.end() && told->second > step;
  });
}

bool MergedStates::is_over(core::Step step, const Pending& pending, const std::set<core::RegionId>& regions,
                           double now_s) const {
  const bool is_late = now_s - pending.since_s > settings_.patience_s;
  const bool all_have_told =
      std::ranges::all_of(regions, [&](core::RegionId region) { return pending.hosted.contains(region); });
  // Before the first whole state, some regions have not received the interest. In a paused run this is the only state,
  // so it is not given up.
  if (!all_have_told) return have_passed(step, regions) || (has_given_ && is_late);
  return is_late || missing_in(all_of(pending.hosted, pending.made_up)).empty() ||
         have_passed(step + settings_.latest_steps, regions);
}

MergedState MergedStates::merge(core::Step step, const Pending& pending,
                                const std::set<core::RegionId>& regions) const {
  MergedState state;
  state.generation = *generation_;
  state.redo = pending.redo;
  state.step = step;
  for (const core::RegionId region : regions) {
    if (!pending.hosted.contains(region)) state.silent.push_back(region);
  }
  const Observations all = all_of(pending.hosted, pending.made_up);
  state.missing = missing_in(all);
  for (const auto& [source, observation] : pending.hosted) {
    state.sequence = state.sequence == 0 ? observation.sequence : std::min(state.sequence, observation.sequence);
    state.scene_order = std::max(state.scene_order, observation.scene_order);
  }
  state.bodies = bodies_of(all);
  for (const core::Observation* observation : all) {
    state.joints.insert(state.joints.end(), observation->joints.begin(), observation->joints.end());
    state.contacts.insert(state.contacts.end(), observation->contacts.begin(), observation->contacts.end());
  }
  std::ranges::sort(state.joints, {}, &core::JointState::id);
  std::ranges::stable_sort(state.contacts, {}, [](const core::ContactImpulse& c) { return std::pair(c.a, c.b); });
  // A joint that is under way twice is in two observations.
  const auto same_joint = [](const core::JointState& x, const core::JointState& y) { return x.id == y.id; };
  state.joints.erase(std::unique(state.joints.begin(), state.joints.end(), same_joint), state.joints.end());
  const auto same_pair = [](const core::ContactImpulse& x, const core::ContactImpulse& y) {
    return x.a == y.a && x.b == y.b;
  };
  state.contacts.erase(std::unique(state.contacts.begin(), state.contacts.end(), same_pair), state.contacts.end());
  return state;
}

std::vector<MergedState> MergedStates::take(const std::set<core::RegionId>& regions, double now_s) {
  std::vector<MergedState> states;
  while (!pending_.empty() && !regions.empty()) {
    const auto& [step, pending] = *pending_.begin();
    if (is_left_out(step, pending)) {
      pending_.erase(pending_.begin());
      continue;
    }
    if (!is_over(step, pending, regions, now_s)) break;
    MergedState state = merge(step, pending, regions);
    // Before the first whole state, some regions have not received the interest yet.
    if (state.silent.empty() || has_given_) {
      given_ = step;
      has_given_ = true;
      states.push_back(std::move(state));
    }
    pending_.erase(pending_.begin());
  }
  const core::Step first = pending_.empty() ? given_ + 1 : std::min(pending_.begin()->first, given_ + 1);
  std::erase_if(left_out_, [first](const LeftOut& states) { return states.last < first; });
  return states;
}

}  // namespace aurasim::agent
