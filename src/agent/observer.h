// One observer of a client: its interest, and the states received for it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "agent/asked_interest.h"
#include "agent/merged_states.h"
#include "agent/seen_scene.h"
#include "dds/observation_bus.h"
#include "overseer/world_watch.h"

namespace aurasim::agent {

struct Observed {
  MergedState state;  ///< only the bodies asked for
  std::vector<FanResult> fans;
  std::vector<TriggerResult> triggers;
  std::uint64_t skipped = 0;  ///< states before this one that the client, or this process, was too slow for
};

/// May be used by one thread only.
class Observer {
 public:
  /// `participant` and `watch` must outlive the observer.
  Observer(dds::Participant& participant, const overseer::WorldWatch& watch, AskedInterest asked);

  /// Takes in what has come. May be called as often as wanted. `regions`: live regions.
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
  std::vector<Surroundings> surroundings_;  ///< those of fans, then those of triggers
  std::vector<Trigger> triggers_;
  struct Whole {
    MergedState state;
    double since_s = 0;
  };
  std::deque<Whole> whole_;  ///< states that wait until the scene is known as it was in them
  std::deque<Observed> ready_;
  struct Place {
    core::Generation generation = 0;
    std::uint32_t redo = 0;
    core::Step step = -1;
  };
  Place last_;  ///< the last whole state
  std::uint64_t skipped_ = 0;
};

/// The observers of one client, by number.
using Observers = std::map<std::uint64_t, std::unique_ptr<Observer>>;

}  // namespace aurasim::agent
