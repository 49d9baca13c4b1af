// The run commands that a node has received: which are plausible, which are for the world that it computes, and which
// have to wait. A command for a world that has not begun here waits until it begins. A command for a world that all
// have left for that of a restore is sent once more by the node that sent the restore. Uses no DDS: time is passed in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "messages/control_messages.h"
#include "process/run_control_limits.h"
#include "process/world_meant.h"

namespace aurasim::process {

class CommandQueue {
 public:
  using Time = RunControlLimits::Time;

  /// A world begins, or goes on from an earlier state: `step`.
  void begin(core::Step step, Time now) { limits_.begin(step, now); }
  /// The node is in this state.
  void note(core::Step step, Time now) { limits_.note(step, now); }
  /// Why the command is not plausible (RunControlLimits); empty if it is.
  std::string problem_with(const messages::RunCommand& command, core::Generation generation,
                           std::int64_t now_ns) const {
    return limits_.problem_with(command, generation, now_ns);
  }

  /// True if the command is for the world that the node computes. Otherwise keeps it, or drops it where its world is
  /// over. `known`: the generations that the node knows; Worlds::begun is filled in here.
  bool is_for_now(const messages::RunCommand& command, Worlds known);
  /// The world of this generation computes. Returns the commands for it that came before it began here. The start of
  /// the world would have undone them.
  std::vector<messages::RunCommand> take_early(core::Generation generation);
  /// Returns the commands for worlds that all have left. Some nodes may have executed them and some not.
  std::vector<messages::RunCommand> take_late() { return std::exchange(late_, {}); }

 private:
  RunControlLimits limits_;
  std::optional<core::Generation> begun_;  ///< generation that the node computes, or has computed last
  std::vector<messages::RunCommand> early_, late_;
};

}  // namespace aurasim::process
