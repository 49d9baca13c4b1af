// In which state a node of a paused run stands, and what it waits for before it goes on. No clock, no DDS: time is
// passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/setpoint.h"
#include "dds/control_messages.h"

namespace aurasim::cli {

/// The steps that clients have asked for in a pause. A step names the state that its sender knew, and how many states
/// it wants. Steps add up, also those of clients that knew the same state: each is as many states more. Nodes may
/// receive them in any order and come to the same state.
class AskedSteps {
 public:
  /// The run stands, or is to stand, in `state`: steps that were asked for before are done or void.
  void begin(core::Step state);
  /// A step command. One of another generation than those before begins anew.
  void add(const dds::RunCommand& step);
  /// Where all of them lead.
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
  std::vector<Asked> asked_;  ///< ascending; the newest kMost of them, begin_ has the others
};

/// Follows nodes that stand in a later state. Nodes that catch up may be past the state of a pause before they hear of
/// it: then the others compute up to where they are. Whoever is ahead by a step is not followed at once, because a step
/// may name words of programs that have to be heard first: it waits as long as the command may be under way.
class PauseFollower {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// The state in which this node is to stand. `farthest`: the latest state in which another node stands.
  core::Step holds_at(core::Step holds_at, core::Step farthest, Time now);

 private:
  std::optional<Time> behind_since_;
};

/// Words of programs that steps name: no state is computed until all have been heard.
class AwaitedWords {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using HasHeard = std::function<bool(const core::ProgramWord&)>;

  /// Of a step.
  void add(const dds::RunCommand& step, Time now);
  /// Another world begins: what was said to the one before is not waited for.
  void clear() { words_.clear(); }
  /// Have all been heard? A word that has not come after a second never will: its program has ended, or this node has
  /// taken the region over since. It is given up, so that the nodes of a run go on together.
  bool are_here(const HasHeard& has_heard, Time now);
  /// Words that were given up since the last call.
  std::vector<core::ProgramWord> take_given_up() { return std::exchange(given_up_, {}); }

 private:
  struct Awaited {
    core::ProgramWord word;
    Time since;
  };
  std::vector<Awaited> words_;
  std::vector<core::ProgramWord> given_up_;
};

}  // namespace aurasim::cli
