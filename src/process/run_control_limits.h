// Checks whether a run command is plausible, by the state that it names and the time. A command that comes late is
// plausible. One with a state long past, a step decades ahead, or an unknown generation is not. Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>

#include "messages/control_messages.h"

namespace aurasim::process {

class RunControlLimits {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// To be called when a world begins, or goes on from an earlier state. The past of the world before is dropped.
  void begin(core::Step step, Time now) { past_ = {{now, step}}; }
  /// Notes that the node is in this state.
  void note(core::Step step, Time now);

  /// Why the command is not plausible; empty if it is. `now_ns`: time of our wall clock. `generation`: the newest known
  /// one.
  std::string problem_with(const messages::RunCommand& command, core::Generation generation, std::int64_t now_ns) const;

 private:
  std::string problem_with_state(const messages::RunCommand& command) const;

  struct Past {
    Time when;
    core::Step step = 0;
  };
  std::deque<Past> past_;  ///< states of the last seconds, oldest first
};

}  // namespace aurasim::process
