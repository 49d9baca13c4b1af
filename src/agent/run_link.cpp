#include "agent/run_link.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"
#include "steering/drain.h"

namespace aurasim::agent {
namespace {

using namespace std::chrono_literals;
using Steer = messages::RunCommandKind;

constexpr auto kPatienceWithObservation = 5s;  ///< for observations that a node does not send
constexpr std::size_t kMostObservers = 16;     ///< of one client
constexpr auto kPatienceWithSilence = 5s;      ///< silence of all nodes after which the run counts as ended
constexpr auto kStillHereEvery = 20ms;
constexpr auto kLongestWayOfStatus = 50ms;    ///< statuses of two nodes may come in the wrong order
constexpr auto kPatienceAmongStrangers = 3s;  ///< our nodes would have been discovered as soon as they

}  // namespace

RunLink::RunLink(const config::Launch& launch, const std::optional<security::Member>& member)
    : launch_(launch),
      member_(member),
      participant_(setup::with_keys(setup::dds_settings(launch), launch, member)),
      control_(participant_, {.agreement = launch.agreement(),
                              .region_count = static_cast<std::uint32_t>(launch.regions.size()),
                              .only_sends = true}),
      steering_(launch_, control_),
      client_(participant_, control_, launch.agreement()),
      watch_(launch, participant_, control_) {}

void RunLink::turn(std::chrono::milliseconds time_out) {
  watch_.look(time_out);
  while (watch_.view().compose(overseer::view_clock_s()) != nullptr) {
  }
  hear_of_standing_states();
  if (!observers_.empty()) {
    const std::set<core::RegionId> live = live_regions();
    for (const auto& [number, observer] : observers_) observer->turn(live);
  }
  if (has_met_) look_for_the_end();
  say_still_here();
}

/// Sends a sign of life, because nodes would otherwise take the client for dead. It has no effect on bodies.
void RunLink::say_still_here() {
  if (!setpoints_ || Clock::now() < said_last_ + kStillHereEvery) return;
  said_last_ = Clock::now();
  core::Setpoints word;
  word.generation = farthest().generation;
  setpoints_->send(std::move(word));
}

/// Sends signs of life for all states up to `wanted`, because a run that computes many states at once may be done
/// before it receives another message.
void RunLink::say_still_here_until(const Standing& wanted) {
  if (!setpoints_) return;
  const core::Step apart = std::max<core::Step>(1, launch().control_rules().silence / 2);
  core::Step step = stands_in_->step + 1;
  if (said_up_to_.generation == wanted.generation) step = std::max(step, said_up_to_.step + apart);
  for (; step <= wanted.step; step += apart) {
    core::Setpoints word;
    word.generation = wanted.generation;
    word.at_step = step;
    setpoints_->send(std::move(word));
    said_up_to_ = {wanted.generation, step};
  }
}

core::Step RunLink::control(core::Setpoints setpoints, const Patience& patience) {
  if (!setpoints_) setpoints_.emplace(participant_);
  wait_until([this] { return setpoints_->listeners() >= live_regions().size(); }, patience,
             "not every node hears this client");
  const bool is_for_the_next = setpoints.at_step == 0 && is_known_to_stand();
  if (is_for_the_next) setpoints.at_step = known_standing(patience).step + 1;
  setpoints.generation = farthest().generation;
  if (is_for_the_next) said_up_to_ = {setpoints.generation, setpoints.at_step};
  said_last_ = Clock::now();
  const core::Step at_step = setpoints.at_step;
  setpoints_->send(std::move(setpoints));
  return at_step;
}

/// In a paused run this waits until all nodes have the interest, so that no state computed next is left out.
std::uint64_t RunLink::observe(AskedInterest asked, const Patience& patience) {
  if (observers_.size() >= kMostObservers) {
    throw Problem(Kind::kRefused, fmt::format("observers: found one more, allowed: {} at a time", kMostObservers));
  }
  Observer& added =
      *(observers_[++last_observer_] = std::make_unique<Observer>(participant_, watch_, std::move(asked)));
  const auto end = Clock::now() + kPatienceWithObservation;
  while (stands() && !added.has_next() && Clock::now() < end) {
    patience.check("not all nodes have published the first state");
    added.wait(kRound);
    turn(0ms);
  }
  return last_observer_;
}

Observed RunLink::next(std::uint64_t number, const Patience& patience) {
  const auto observer = observers_.find(number);
  if (observer == observers_.end()) throw Problem(Kind::kRefused, "this observer is closed");
  for (;;) {
    if (std::optional<Observed> state = observer->second->next()) return std::move(*state);
    patience.check("no state has been observed");
    observer->second->wait(kRound);
    turn(0ms);
  }
}

void RunLink::look_for_the_end() {
  if (launched_ && !launched_->is_running()) {
    throw Problem(Kind::kEnded, fmt::format("the run has ended, with exit code {}", launched_->exit_code()));
  }
  if (steering_.is_there()) {
    alone_since_.reset();
  } else if (!alone_since_) {
    alone_since_ = Clock::now();
  } else if (Clock::now() > *alone_since_ + setup::kPatienceWithSilence) {
    throw Problem(Kind::kEnded, "the run has ended: none of its nodes is alive any more");
  }
}

void RunLink::wait_until(const std::function<bool()>& condition, const Patience& patience, const std::string& what) {
  while (!condition()) {
    patience.check(what);
    turn(kRound);
  }
}

void RunLink::meet(const Patience& patience) {
  const auto begin = Clock::now();
  const auto computes = [this] {
    const std::set<core::RegionId> live = live_regions();
    // The watch takes messages in at intervals only, so a region that it has not seen yet would not be counted.
    return steering_.is_complete() && watch_.nodes().size() >= launch_.regions.size() &&
           std::ranges::all_of(live,
                               [this](core::RegionId region) {
                                 const messages::NodeState state = watch_.nodes().at(region).status.state;
                                 return state == messages::NodeState::kRunning || state == messages::NodeState::kPaused;
                               }) &&
           !live.empty();
  };
  while (!computes()) {
    if (launched_ && !launched_->is_running()) {
      throw Problem(Kind::kLaunchFailed,
                    fmt::format("the launcher has ended with exit code {}: {}", launched_->exit_code(), last_words()));
    }
    const bool among_strangers = !launched_ && !steering_.is_there() && !control_.strangers().empty();
    if (among_strangers && Clock::now() > begin + kPatienceAmongStrangers) {
      throw Problem(Kind::kRunDiffers,
                    fmt::format("the run in DDS domain {} differs: give the same file and overrides as its nodes have",
                                launch_.dds.domain));
    }
    if (patience.is_over() && steering_.is_there() && !launched_) break;  // some nodes of the run may be gone
    if (patience.is_over() && !launched_) {
      throw Problem(Kind::kNoSuchRun,
                    fmt::format("no run of {} in DDS domain {}{}", launch_.file.string(), launch_.dds.domain,
                                setup::word_about_keys(participant_.peers_by_keys(), launch_)));
    }
    patience.check("the nodes have not begun");
    turn(kRound);
  }
  has_met_ = true;
}

std::set<core::RegionId> RunLink::live_regions() {
  std::set<core::RegionId> live;
  for (const auto& [region, seen] : watch_.nodes()) {
    if (seen.is_live()) live.insert(region);
  }
  return live;
}

const std::map<core::RegionId, messages::SeenStatus>& RunLink::nodes(const Patience& patience) {
  turn(0ms);
  const auto end = Clock::now() + kPatienceWithAReader;
  while (stands_in_ && !all_say_that_they_stand() && Clock::now() < end) {
    patience.check("not every node says that it stands");
    if (farthest() > *stands_in_) break;  // another client has moved the run
    turn(kRound);
  }
  return watch_.nodes();
}

WorldState RunLink::step(std::int64_t count, const Patience& patience) {
  wait_until_it_stands(patience);
  known_standing(patience);
  const Standing wanted{stands_in_->generation, stands_in_->step + count};
  say_still_here_until(wanted);
  watch_standing_states();
  steering_.send_step(wanted.generation, stands_in_->step, count,
                      setpoints_ ? setpoints_->last_word() : core::ProgramWord());
  stands_in_.reset();
  StandingState state(wanted.generation, wanted.step);
  std::optional<Clock::time_point> published_since;
  while (!take_standing(state)) {
    patience.check("not every region has come to that state");
    if (!published_since && all_have_published(wanted)) published_since = Clock::now();
    const bool is_late = published_since && Clock::now() > *published_since + kPatienceWithAReader;
    const bool has_gone_back = farthest().generation > wanted.generation && stands();
    if (is_late || has_gone_back) return standing_state(patience);
    standing_->wait(kRound);
    turn(0ms);
  }
  stands_in_ = Standing{state.generation(), state.step()};
  return {state.generation(), state.step(), true, state.bodies()};
}

/// Waits until the run is paused. A step of another client may be on its way, and a world that has gone back in a pause
/// computes up to the paused state again. A run that is not paused is refused.
void RunLink::wait_until_it_stands(const Patience& patience) {
  const auto begin = Clock::now();
  const auto goes_on = [begin](const messages::SeenStatus& seen) {
    const bool is_news = seen.seen > begin + kLongestWayOfStatus;
    return is_news && seen.is_live() && seen.status.state == messages::NodeState::kRunning && !seen.status.holds_at;
  };
  while (!is_known_to_stand()) {
    patience.check("the run is paused, and has not reached the state in which it is to stop");
    if (std::ranges::any_of(watch_.nodes(), [&](const auto& node) { return goes_on(node.second); })) {
      throw Problem(Kind::kRefused, "steps are for a run that is paused, and this one runs: pause it first");
    }
    turn(kRound);
  }
}

void RunLink::steer(Steer kind, const Patience& patience) {
  const bool stood = kind == Steer::kReset && is_known_to_stand();
  stands_in_.reset();
  if (kind == Steer::kStop) has_met_ = false;  // the end of the run is no error now
  const messages::RunCommand command = steering_.send(kind);
  const auto has_ended = [&] { return launched_ && !launched_->is_running(); };
  // After a reset, wait until the watch has seen the new world, too: it may be behind the statuses.
  const auto is_seen = [&] { return kind != Steer::kReset || farthest().generation > command.generation; };
  wait_until([&] { return (steering_.has_taken_effect(command) && is_seen()) || has_ended(); }, patience,
             fmt::format("{} was sent, but not every node shows its effect", messages::name_of(kind)));
  if (stood) wait_until([this] { return stands(); }, patience, "the run has begun anew, and is not paused yet");
  has_met_ = true;
}

void RunLink::wait_for_listeners(const Patience& patience) {
  wait_until([this] { return client_.all_listen(); }, patience, "not every node hears this client");
}

std::vector<steering::Delivery> RunLink::act(std::vector<core::Command> commands, const Patience& patience) {
  wait_for_listeners(patience);
  const bool stood = is_known_to_stand();
  const core::Generation before = farthest().generation;
  bool changes = false;
  std::map<std::uint64_t, std::size_t> places;
  std::vector<steering::Delivery> deliveries(commands.size());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    changes = changes || core::changes_the_run(commands[i].ask);
    places[client_.send(std::move(commands[i]))] = i;
  }
  while (!places.empty()) {
    patience.check("no answer");
    client_.wait(kRound);
    turn(0ms);
    for (steering::Delivery& delivery : client_.take()) {
      const auto place = places.find(delivery.request);
      if (place == places.end()) continue;  // the reply belongs to an abandoned request
      deliveries[place->second] = std::move(delivery);
      places.erase(place);
    }
  }
  if (changes) {
    stands_in_.reset();
    wait_until([&] { return steering_.is_there() && (!stood || stands()); }, patience, "the run does not go on");
    const bool has_changed = std::ranges::all_of(deliveries, &steering::Delivery::done);
    // The answer may come before the new world's data. Wait for that, so that later requests do not get the old bodies.
    for (const auto end = Clock::now() + kPatienceWithAReader;
         has_changed && farthest().generation <= before && Clock::now() < end;) {
      patience.check("the run does not begin anew");
      turn(kRound);
    }
  }
  return deliveries;
}

std::uint32_t RunLink::drain(core::RegionId region, const Patience& patience) {
  steering::Draining leaving(control_, region);
  const messages::Status* successor = nullptr;
  wait_until([&] { return (successor = leaving.successor()) != nullptr; }, patience, steering::kNobodyTakesOver);
  return successor->pid;
}

}  // namespace aurasim::agent
