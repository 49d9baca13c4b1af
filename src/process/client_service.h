// Serves the commands of clients between two states (command_server.h): orders, saves in a pause, another rate, and the
// way back to an earlier state.
#pragma once

#include "process/command_executor.h"
#include "process/node_runtime.h"

namespace aurasim::process {

class ClientService {
 public:
  ClientService(NodeRuntime& run, CommandExecutor& executor) : run_(run), executor_(executor) {}

  /// To be called between two states. The lead gives orders their state.
  void serve_clients();

 private:
  void compute_until_change();
  void step_back(const RunView& view);
  void send_back(messages::RunCommand restore, const core::Command& back);

  NodeRuntime& run_;
  CommandExecutor& executor_;
};

}  // namespace aurasim::process
