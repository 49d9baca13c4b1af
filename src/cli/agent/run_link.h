// All that an agent has of a run: it sees it like a viewer, and steers it like `aurasim send`.
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

#include "cli/agent/launched_run.h"
#include "cli/agent/observer.h"
#include "cli/agent/patience.h"
#include "cli/agent/standing_state.h"
#include "cli/command_client.h"
#include "cli/run_steering.h"
#include "dds/observation_bus.h"
#include "dds/setpoint_bus.h"
#include "overseer/world_watch.h"
#include "security/key_store.h"

namespace aurasim::cli::agent {

/// The bodies of a state.
struct WorldState {
  core::Generation generation = 0;
  core::Step step = 0;
  bool exact = false;  ///< all of this very state, bit by bit; else as far as they have been published
  std::vector<WorldBody> bodies;
};

/// Used by one thread. Whatever waits throws Problem or Abandoned.
class RunLink {
 public:
  /// Joins the DDS domain, and hears nobody yet.
  RunLink(const config::Launch& launch, const std::optional<security::Member>& member);

  /// A run that this process has started: once it has ended so has the link.
  void own(std::unique_ptr<LaunchedRun> launched) { launched_ = std::move(launched); }
  LaunchedRun* launched() { return launched_.get(); }

  /// All nodes are there and compute, or stand.
  void meet(const Patience& patience);
  /// Takes what has come; as often as you like.
  void turn(std::chrono::milliseconds time_out);

  /// As the run is now.
  const config::Launch& launch() const { return watch_.launch(); }
  const std::optional<security::Member>& member() const { return member_; }
  /// Of a run that this client has made stand: as they stand.
  const std::map<core::RegionId, dds::SeenStatus>& nodes(const Patience& patience);

  WorldState state(const Patience& patience);
  WorldState pause(const Patience& patience);
  WorldState step(std::int64_t count, const Patience& patience);
  /// resume, reset, stop.
  void steer(dds::RunCommandKind kind, const Patience& patience);
  /// Tells all nodes. Returns the state from which on it has effect; 0: as soon as all can know of it. In a run that
  /// stands that is the next state, if none is named.
  core::Step control(core::Setpoints setpoints, const Patience& patience);
  /// In their order.
  std::vector<Delivery> act(std::vector<core::Command> commands, const Patience& patience);
  /// The process that has taken the region over.
  std::uint32_t drain(core::RegionId region, const Patience& patience);
  /// Begins to observe; returns the observer's number. Throws Problem for what cannot be asked for.
  std::uint64_t observe(AskedInterest asked, const Patience& patience);
  /// The next state of it.
  Observed next(std::uint64_t observer, const Patience& patience);
  void end_observer(std::uint64_t observer) { observers_.erase(observer); }
  CommandClient& client() { return client_; }
  void wait_for_listeners(const Patience& patience);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRound{2};
  static constexpr std::chrono::seconds kPatienceWithAReader{1};  ///< that some node has not found
  static constexpr std::chrono::seconds kMoment{1};  ///< of simulated time: a step that takes no longer is waited for
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
  using When = std::tuple<core::Generation, std::uint32_t, core::Step>;  ///< with the redo: which state, and which one
  static When when(const core::Observation& told) { return {told.generation, told.redo, told.stamp}; }
  When newest_told() const;
  void hear_of_standing_states();
  bool take_standing(StandingState& state);
  WorldState seen_state(const Patience& patience);
  const Standing& known_standing(const Patience& patience);
  void say_still_here();
  void say_still_here_until(const Standing& wanted);

  config::Launch launch_;  ///< as it was given
  std::optional<security::Member> member_;
  dds::Participant participant_;
  dds::ControlBus control_;
  RunSteering steering_;
  CommandClient client_;
  overseer::WorldWatch watch_;
  std::optional<dds::SetpointWriter> setpoints_;  ///< once it has steered anything
  Clock::time_point said_last_;                   ///< that it is still here
  Standing said_up_to_;  ///< it has said so for this state, and for all before it no longer ago than silence allows
  std::unique_ptr<LaunchedRun> launched_;
  std::optional<Standing> stands_in_;                 ///< as all regions have shown; nothing: not known
  std::optional<dds::ObserverEndpoint> standing_;     ///< tells all bodies of states in which the run stands
  std::map<core::RegionId, core::Observation> told_;  ///< by it, the last of each region
  std::vector<core::Observation> foreseen_;           ///< by it, of bodies under way in the newest of these states
  Observers observers_;
  std::uint64_t last_observer_ = 0;
  bool has_met_ = false;
  std::optional<Clock::time_point> alone_since_;
};

}  // namespace aurasim::cli::agent
