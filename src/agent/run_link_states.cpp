// The state in which a run is paused, and the bodies of a state, from its nodes' messages.
#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "agent/run_link.h"

namespace aurasim::agent {

using namespace std::chrono_literals;

/// True if the run is paused, or will be in a moment after another client's step. After an own step this is known
/// before the statuses show it.
bool RunLink::is_known_to_stand() {
  if (!steering_.is_there()) return false;
  const auto moment = static_cast<core::Step>(launch().time.step_hz * kMoment.count());
  return steering_.is_paused_within(moment) || stands_in_ == farthest();
}

bool RunLink::stands() { return steering_.is_there() && steering_.is_paused(); }

/// The farthest state in any message of live nodes. A status may be older than replicas or observations.
RunLink::Standing RunLink::farthest() {
  const std::set<core::RegionId> live = live_regions();
  Standing farthest;
  for (const core::RegionId region : live) {
    farthest.generation = std::max(farthest.generation, watch_.nodes().at(region).status.generation);
  }
  for (const core::RegionId region : live) {
    const messages::Status& status = watch_.nodes().at(region).status;
    if (status.generation == farthest.generation) farthest.step = std::max(farthest.step, status.step);
    farthest.step = std::max(farthest.step, watch_.published(region, farthest.generation));
    const auto told = told_.find(region);
    if (told != told_.end()) farthest = std::max(farthest, Standing{told->second.generation, told->second.stamp});
  }
  return farthest;
}

/// True if the statuses of all live nodes say that they are paused. Statuses come after the states that nodes publish.
bool RunLink::all_say_that_they_stand() {
  return std::ranges::all_of(live_regions(), [&](core::RegionId region) {
    const messages::Status& status = watch_.nodes().at(region).status;
    return status.state == messages::NodeState::kPaused && Standing{status.generation, status.step} >= *stands_in_;
  });
}

bool RunLink::all_have_published(const Standing& wanted) {
  const std::set<core::RegionId> live = live_regions();
  return !live.empty() && std::ranges::all_of(live, [&](core::RegionId region) {
    return watch_.published(region, wanted.generation) >= wanted.step;
  });
}

/// Starts to observe paused states. After that, nodes send all bodies of each state in which they pause.
void RunLink::watch_standing_states() {
  if (!standing_) {
    standing_.emplace(participant_, watch_.observer_settings());
    core::Interest all;
    all.every = 0;
    all.all = true;
    standing_->want(all);
  }
}

void RunLink::hear_of_standing_states() {
  if (!standing_) return;
  standing_->use(watch_.observer_settings());
  for (core::Observation& observation : standing_->take()) {
    if (observation.kind == core::Observation::Kind::kMadeUp) {
      foreseen_.push_back(std::move(observation));
      continue;
    }
    const core::RegionId source = observation.source;
    told_.insert_or_assign(source, std::move(observation));
  }
  const When newest = newest_told();
  std::erase_if(foreseen_, [&newest](const core::Observation& one) { return when(one) < newest; });
}

RunLink::When RunLink::newest_told() const {
  When newest{};
  for (const auto& [region, told] : told_) newest = std::max(newest, when(told));
  return newest;
}

/// True once `state` is complete: all regions have sent the same state, and the place of each body under way is known.
/// Observations from before a redo do not count.
bool RunLink::take_standing(StandingState& state) {
  const When newest = newest_told();
  const bool all_have_told = std::ranges::all_of(live_regions(), [&](core::RegionId region) {
    const auto told = told_.find(region);
    return told != told_.end() && when(told->second) == newest;
  });
  if (!all_have_told) return false;
  StandingState found = state;
  for (const auto& [region, told] : told_) {
    if (when(told) == newest) found.accept(told);
  }
  for (const core::Observation& one : foreseen_) {
    if (when(one) == newest) found.accept(one);
  }
  const bool is_whole = found.is_complete(live_regions()) && found.missing().empty();
  if (is_whole) state = std::move(found);
  return is_whole;
}

/// Collects the paused state. False if the run is not paused, or some node has not discovered this reader.
bool RunLink::collect(StandingState& state, const Patience& patience) {
  watch_standing_states();
  const auto end = Clock::now() + kMoment + kPatienceWithAReader;
  while (!take_standing(state)) {
    patience.check("not all regions have published the state in which the run is paused");
    if (Clock::now() > end) return stands() && collect_key_frames(state, patience);
    if (!is_known_to_stand()) return false;
    standing_->wait(kRound);
    turn(0ms);
    const Standing newest = farthest();
    if (newest.generation > state.generation()) state = StandingState(newest.generation, newest.step);  // begun anew
  }
  return true;
}

/// Collects the paused state from key frames, which nodes publish for a new reader.
bool RunLink::collect_key_frames(StandingState& state, const Patience& patience) {
  dds::ReplicaReader reader(participant_, watch_.observer_settings());
  const auto end = Clock::now() + kPatienceWithAReader;
  while (!state.is_complete(live_regions())) {
    patience.check("not all regions have published the state in which they stand");
    if (Clock::now() > end) return false;
    reader.wait(kRound);
    for (core::Replica& replica : reader.take()) state.accept(std::move(replica));
    turn(0ms);
  }
  return true;
}

/// The state in which the run is paused. Nothing in the cases in which collect() returns false.
std::optional<WorldState> RunLink::look_at_standing_state(const Patience& patience) {
  const Standing least = farthest();
  StandingState state(least.generation, least.step);
  if (!collect(state, patience)) return std::nullopt;
  stands_in_ = Standing{state.generation(), state.step()};
  return WorldState{state.generation(), state.step(), state.missing().empty(), state.bodies()};
}

WorldState RunLink::standing_state(const Patience& patience) {
  for (;;) {
    if (std::optional<WorldState> state = look_at_standing_state(patience)) return *std::move(state);
    patience.check("the run does not stand");
    turn(kRound);
  }
}

/// The newest published bodies of a run that is not paused.
WorldState RunLink::seen_state(const Patience& patience) {
  const auto all_are_seen = [this] {
    const overseer::WorldView& view = watch_.view();
    return view.stamp() >= 0 &&
           std::ranges::all_of(live_regions(), [&](core::RegionId region) { return view.is_whole(region); });
  };
  wait_until(all_are_seen, patience, "no state of all regions has been published");
  const overseer::WorldView& view = watch_.view();
  WorldState state{view.generation(), view.stamp(), false, {}};
  view.for_each([&state](const overseer::ViewBody& body) {
    core::ReplicaBody row{body.id,   body.epoch, body.host, body.prototype, body.asleep,
                          body.p_WB, body.q_WB,  body.v_WB, body.w_WB};
    state.bodies.push_back({row, body.under_way});
  });
  std::ranges::sort(state.bodies, {}, [](const WorldBody& body) { return body.row.id; });
  return state;
}

WorldState RunLink::state(const Patience& patience) {
  turn(0ms);
  while (is_known_to_stand()) {
    if (std::optional<WorldState> state = look_at_standing_state(patience)) return *std::move(state);
  }
  return seen_state(patience);
}

WorldState RunLink::pause(const Patience& patience) {
  if (!stands()) {
    const messages::RunCommand command = steering_.send(messages::RunCommandKind::kPause);
    wait_until([&] { return steering_.has_taken_effect(command); }, patience, "not every node shows the pause");
  }
  return standing_state(patience);
}

/// The state in which the run is paused.
const RunLink::Standing& RunLink::known_standing(const Patience& patience) {
  const Standing said = farthest();  // another client may have moved the run
  if (!stands_in_ || stands_in_->generation != said.generation || stands_in_->step < said.step) {
    standing_state(patience);
  }
  return *stands_in_;
}

}  // namespace aurasim::agent
