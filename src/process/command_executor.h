// Executes the run commands that a node receives (command_queue.h decides which count, run_schedule.h applies most
// of them).
#pragma once

#include "process/node_runtime.h"
#include "process/succession.h"

namespace aurasim::process {

class CommandExecutor {
 public:
  CommandExecutor(NodeRuntime& run, Succession& succession) : run_(run), succession_(succession) {}

  /// Executes the commands that have come since the last call.
  void execute_commands();
  /// Executes the commands for the present world that came before it began here.
  void execute_early_commands();
  /// Handles commands for a world that all have left. The node that sent the restore sends them once more, and all
  /// execute those.
  void execute_late_commands();
  /// Sends a command to all nodes and executes it here.
  void command_all(messages::RunCommand command);
  /// Begins the world anew if a reset is due. True if it has begun.
  bool reset_if_due();

 private:
  void execute(const messages::RunCommand& command);
  void execute_end(const messages::RunCommand& end);
  void execute_restore(const messages::RunCommand& restore);
  void apply(const messages::RunCommand& command);
  bool is_plausible(const messages::RunCommand& command);
  Worlds known_worlds() const;

  NodeRuntime& run_;
  Succession& succession_;
};

}  // namespace aurasim::process
