// An agent's connection to a run. It observes the run as a viewer does, and steers it as `aurasim send` does.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "agent/launched_run.h"
#include "agent/observer.h"
#include "agent/patience.h"
#include "agent/standing_state.h"
#include "dds/observation_bus.h"
#include "dds/setpoint_bus.h"
#include "overseer/world_watch.h"
#include "security/key_store.h"
#include "steering/command_client.h"
#include "steering/run_steering.h"

namespace aurasim::agent {

/// The bodies of a state.
struct WorldState {
  core::Generation generation = 0;
  core::Step step = 0;
  bool exact = false;  ///< true: all bodies of this very state, bit by bit; false: the newest published ones
  std::vector<WorldBody> bodies;
};

/// May be used by one thread only. Functions with a Patience throw Problem or Abandoned.
class RunLink {
 public:
  /// Joins the DDS domain. No node has been discovered yet.
  RunLink(const config::Launch& launch, const std::optional<security::Member>& member);

  /// Takes a run that this process has launched. When that ends, the link has ended, too.
  void own(std::unique_ptr<LaunchedRun> launched) { launched_ = std::move(launched); }
  LaunchedRun* launched() { return launched_.get(); }

  /// Waits until all nodes are there and compute or are paused.
  void meet(const Patience& patience);
  /// Takes in what has come. May be called as often as wanted.
  void turn(std::chrono::milliseconds time_out);

  /// The run's present launch.
  const config::Launch& launch() const { return watch_.launch(); }
  const std::optional<security::Member>& member() const { return member_; }
  /// The nodes' statuses. If this client has paused the run, they show the paused state.
  const std::map<core::RegionId, messages::SeenStatus>& nodes(const Patience& patience);

  WorldState state(const Patience& patience);
  WorldState pause(const Patience& patience);
  WorldState step(std::int64_t count, const Patience& patience);
  /// Sends resume, reset or stop, and waits for the effect.
  void steer(messages::RunCommandKind kind, const Patience& patience);
  /// Sends setpoints to all nodes. Returns the state in which they take effect; 0: as soon as all nodes can have them.
  /// In a paused run that is the next state if none is named.
  core::Step control(core::Setpoints setpoints, const Patience& patience);
  /// Executes commands and returns their outcomes in the same order.
  std::vector<steering::Delivery> act(std::vector<core::Command> commands, const Patience& patience);
  /// Drains a region. Returns the process that has taken it over.
  std::uint32_t drain(core::RegionId region, const Patience& patience);
  /// Begins to observe; returns the observer's number. Throws Problem for what cannot be asked for.
  std::uint64_t observe(AskedInterest asked, const Patience& patience);
  /// The next state of an observer.
  Observed next(std::uint64_t observer, const Patience& patience);
  void end_observer(std::uint64_t observer) { observers_.erase(observer); }
  steering::CommandClient& client() { return client_; }
  void wait_for_listeners(const Patience& patience);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRound{2};
  static constexpr std::chrono::seconds kPatienceWithAReader{1};  ///< time for nodes to discover a reader
  static constexpr std::chrono::seconds kMoment{1};  ///< simulated time: steps that take no longer are waited for
  struct Standing {
    core::Generation generation = 0;
    core::Step step = 0;

    auto operator<=>(const Standing&) const = default;
  };

  void wait_until(const std::function<bool()>& condition, const Patience& patience, const std::string& what);
  void look_for_the_end();
  std::set<core::RegionId> live_regions();
  Standing farthest();
  bool stands();
  bool is_known_to_stand();
  void wait_until_it_stands(const Patience& patience);
  bool all_have_published(const Standing& wanted);
  bool all_say_that_they_stand();
  std::optional<WorldState> look_at_standing_state(const Patience& patience);
  WorldState standing_state(const Patience& patience);
  bool collect(StandingState& state, const Patience& patience);
  bool collect_key_frames(StandingState& state, const Patience& patience);
  void watch_standing_states();
  using When = std::tuple<core::Generation, std::uint32_t, core::Step>;  ///< generation, redo and state
  static When when(const core::Observation& told) { return {told.generation, told.redo, told.stamp}; }
  When newest_told() const;
  void hear_of_standing_states();
  bool take_standing(StandingState& state);
  WorldState seen_state(const Patience& patience);
  const Standing& known_standing(const Patience& patience);
  void say_still_here();
  void say_still_here_until(const Standing& wanted);

  config::Launch launch_;  ///< the launch as given to the constructor
  std::optional<security::Member> member_;
  dds::Participant participant_;
  dds::ControlBus control_;
  steering::RunSteering steering_;
  steering::CommandClient client_;
  overseer::WorldWatch watch_;
  std::optional<dds::SetpointWriter> setpoints_;  ///< set once setpoints have been sent
  Clock::time_point said_last_;                   ///< when the last sign of life was sent
  Standing said_up_to_;  ///< it has said so for this state, and for all before it no longer ago than silence allows
  std::unique_ptr<LaunchedRun> launched_;
  std::optional<Standing> stands_in_;                 ///< the state in which all regions are paused; nothing: unknown
  std::optional<dds::ObserverEndpoint> standing_;     ///< receives all bodies of paused states
  std::map<core::RegionId, core::Observation> told_;  ///< from standing_, the last observation of each region
  std::vector<core::Observation> foreseen_;  ///< from standing_, of bodies under way in the newest of these states
  Observers observers_;
  std::uint64_t last_observer_ = 0;
  bool has_met_ = false;
  std::optional<Clock::time_point> alone_since_;
};

}  // namespace aurasim::agent
