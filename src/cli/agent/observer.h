// One observer of a client: what it has asked for, and the states that have come of it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "cli/agent/asked_interest.h"
#include "cli/agent/merged_states.h"
#include "cli/agent/seen_scene.h"
#include "dds/observation_bus.h"
#include "overseer/world_watch.h"

namespace aurasim::cli::agent {

struct Observed {
  MergedState state;  ///< of the bodies that were asked for
  std::vector<FanResult> fans;
  std::vector<TriggerResult> triggers;
  std::uint64_t skipped = 0;  ///< states before this one that the client, or this process, was too slow for
};

/// Used by one thread.
class Observer {
 public:
  /// The participant and the watch outlive it.
  Observer(dds::Participant& participant, const overseer::WorldWatch& watch, AskedInterest asked);

  /// Takes in what has come; as often as you like. `regions`: those that are alive.
  void turn(const std::set<core::RegionId>& regions);
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out) { endpoint_.wait(time_out); }
  bool has_next() const { return !ready_.empty(); }
  /// The oldest state that has not been given out.
  std::optional<Observed> next();

 private:
  void want();
  void sense_what_is_known(double now_s);
  std::uint64_t states_left_out_before(const MergedState& state);
  void look_around(const MergedState& state);
  Observed sense(MergedState state);
  FanResult cast(std::size_t i, const MergedState& state) const;
  bool is_known(const Surroundings& surroundings, const MergedState& state) const;
  void keep_what_is_wanted(MergedState& state) const;

  const overseer::WorldWatch& watch_;
  AskedInterest asked_;
  dds::ObserverEndpoint endpoint_;
  MergedStates states_;
  std::optional<SeenScene> scene_;          ///< for rays
  std::vector<Surroundings> surroundings_;  ///< of fans, then of triggers
  std::vector<Trigger> triggers_;
  struct Whole {
    MergedState state;
    double since_s = 0;
  };
  std::deque<Whole> whole_;  ///< perhaps the scene is not yet known as it was in them
  std::deque<Observed> ready_;
  struct Place {
    core::Generation generation = 0;
    std::uint32_t redo = 0;
    core::Step step = -1;
  };
  Place last_;  ///< of the last state that was whole
  std::uint64_t skipped_ = 0;
};

/// Those of one client, by number.
using Observers = std::map<std::uint64_t, std::unique_ptr<Observer>>;

}  // namespace aurasim::cli::agent
