// The state in which a node of a paused run waits, and what it waits for before it goes on. Uses no clock and no DDS:
// time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "core/setpoint.h"
#include "messages/control_messages.h"

namespace aurasim::process {

/// The steps that clients have asked for in a pause. A step names the state that its sender knew, and how many states
/// it wants. Steps add up, also those of clients that knew the same state: each is as many states more. Nodes may
/// receive them in any order and come to the same state.
class AskedSteps {
 public:
  /// The run is paused, or is to pause, in `state`. Steps asked for before are done or void.
  void begin(core::Step state);
  /// Adds a step command. A command of another generation drops those before it.
  void add(const messages::RunCommand& step);
  /// The state that all steps added up lead to.
  core::Step end() const;

 private:
  struct Asked {
    core::Step from = 0;  ///< the state that the sender knew
    std::uint64_t request = 0;
    std::int64_t count = 0;

    auto operator<=>(const Asked&) const = default;
  };

  core::Generation generation_ = 0;
  core::Step begin_ = 0;
  std::vector<Asked> asked_;  ///< ascending; at most the newest kMost commands; begin_ includes the older ones
};

/// Follows nodes that pause in a later state. A node that catches up may be past the state of a pause before it
/// receives the command; then the other nodes compute up to its state. A node that is ahead because of a step command
/// is not followed at once, because a step may name setpoints that have to be received first. The delay is the longest
/// time that the command may be under way.
class PauseFollower {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// The state in which this node is to pause. `farthest`: the latest state in which another node is paused.
  core::Step holds_at(core::Step holds_at, core::Step farthest, Time now);

 private:
  std::optional<Time> behind_since_;
};

/// The latest state in which a live node of this generation is paused; 0: none is.
core::Step farthest_pause(const std::map<core::RegionId, messages::SeenStatus>& nodes, core::Generation generation);

/// Setpoint messages of programs that step commands name. No state is computed until all have been received.
class AwaitedWords {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using HasReceived = std::function<bool(const core::ProgramWord&)>;

  /// Adds the messages that a step command names.
  void add(const messages::RunCommand& step, Time now);
  /// To be called when another world begins. Messages sent to the world before are not waited for.
  void clear() { words_.clear(); }
  /// True if all messages have been received. A message that has not come after a second never will: its program has
  /// ended, or this node has taken the region over since. Such a message is given up, so that the nodes of a run go on
  /// together.
  bool are_here(const HasReceived& has_received, Time now);
  /// True if a message, or a later one of its program, is awaited.
  bool name(const core::ProgramWord& word) const;
  /// Messages that were given up since the last call.
  std::vector<core::ProgramWord> take_given_up() { return std::exchange(given_up_, {}); }

 private:
  struct Awaited {
    core::ProgramWord word;
    Time since;
  };
  std::vector<Awaited> words_;
  std::vector<core::ProgramWord> given_up_;
};

}  // namespace aurasim::process
