// What can be meant by a run command, by the state that it names and the time. A command that comes late is still one;
// a state long past, a step decades ahead, or a generation out of nowhere is not. Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>

#include "dds/control_messages.h"

namespace aurasim::cli {

class RunControlLimits {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A world begins, or goes on from an earlier state: what was past in the one before says nothing of it.
  void begin(core::Step step, Time now) { past_ = {{now, step}}; }
  /// The node is in this state.
  void note(core::Step step, Time now);

  /// Why it cannot be meant; empty: it can. `now_ns`: of our wall clock. `generation`: the newest that is known.
  std::string problem_with(const dds::RunCommand& command, core::Generation generation, std::int64_t now_ns) const;

 private:
  std::string problem_with_state(const dds::RunCommand& command) const;

  struct Past {
    Time when;
    core::Step step = 0;
  };
  std::deque<Past> past_;  ///< of the last seconds, oldest first
};

}  // namespace aurasim::cli
