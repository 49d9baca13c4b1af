// The phases kLingering, kDone and kFenced of a node: ends its run, and leaves so that the other nodes can end theirs.
#pragma once

#include "command_line/exit_code.h"
#include "process/command_executor.h"
#include "process/node_runtime.h"

namespace aurasim::process {

class EndingPhase {
 public:
  EndingPhase(NodeRuntime& run, CommandExecutor& executor) : run_(run), executor_(executor) {}

  /// Finishes the world and the records. Throws SomebodyDied if all have to go back once more.
  command_line::ExitCode end();
  /// Ends a process of a run that has broken off, which has no world yet.
  command_line::ExitCode end_without_world();

 private:
  void linger();
  bool others_have_left();
  bool has_all_of_the_last_states();

  NodeRuntime& run_;
  CommandExecutor& executor_;
};

}  // namespace aurasim::process
