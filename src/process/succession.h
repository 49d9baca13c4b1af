// Sees to it that regions get other processes: calls spares, starts processes on this host, and leaves this process's
// region to its successor. The decisions are in leaving.h and recovery.h.
#pragma once

#include "command_line/exit_code.h"
#include "process/node_runtime.h"

namespace aurasim::process {

class Succession {
 public:
  explicit Succession(NodeRuntime& run) : run_(run) {}

  /// Calls a spare for this region, if there is one that was not called before.
  void call_spare(core::RegionId region);
  /// Starts a second process on this host, which takes the region over.
  void spawn_successor(core::RegionId region);
  /// Executes a drain command: a node is to leave. Its launcher starts a successor. If nodes were started by hand, the
  /// lowest region calls a spare; if there is none, the host of the next region starts a process.
  void execute_drain(const messages::RunCommand& drain);
  /// Begins to leave after a SIGTERM.
  void leave_if_asked();
  /// True if another node stays that can go on with this node's world.
  bool can_leave_to_others();
  /// True if this process was asked to leave, and nobody takes its region over: nobody stays, or nobody has come.
  bool leaves_in_vain();
  /// True if this node gives its region to another process and that costs the run least now.
  bool leaves_now();
  /// Leaves the region to a successor. To the others it is as a death.
  command_line::ExitCode leave_to_successor();

 private:
  NodeRuntime& run_;
};

}  // namespace aurasim::process
