// The phases kRecovering and kSpare of a node: one of the nodes has died, and all wait until a process has taken its
// region over, agree on a state that is kept, and go back to it (docs/design.md, "When a node dies"). A step back that
// a client asks for ends in the same way. The decisions are in recovery.h, restoration.h and restore_plan.h.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "process/command_executor.h"
#include "process/node_runtime.h"
#include "process/succession.h"

namespace aurasim::process {

class RecoveringPhase {
 public:
  RecoveringPhase(NodeRuntime& run, CommandExecutor& executor, Succession& succession)
      : run_(run), executor_(executor), succession_(succession) {}

  /// Returns when the world goes on, the run ends, or this node has to leave it. `why`: for the log.
  void recover(const std::string& why);

 private:
  void begin_to_recover();
  bool agree_on_restore();
  void execute(const RecoveryActs& acts);
  void join_anew();
  bool has_to_leave_recovery(const SeenNodes& nodes);
  void give_up(const std::vector<core::RegionId>& vacant);
  void lead_recovery();
  bool may_begin_again(core::Generation era);
  void go_back();
  void take_map_of(const messages::RunCommand& restore);
  void wait_in_recovery(std::chrono::steady_clock::time_point deadline, const char* for_what);

  NodeRuntime& run_;
  CommandExecutor& executor_;
  Succession& succession_;
};

}  // namespace aurasim::process
