// The phase kChanging of a node: the run gets another scene, another world or other regions. All nodes come to a change
// after the same state, and connect anew for it. The decisions are in run_changes.h and region_change.h.
#pragma once

#include <string>
#include <vector>

#include "process/command_executor.h"
#include "process/node_runtime.h"

namespace aurasim::process {

class ChangingPhase {
 public:
  ChangingPhase(NodeRuntime& run, CommandExecutor& executor) : run_(run), executor_(executor) {}

  /// Removes the orders about the run as a whole whose state has been computed. A change becomes due, and the node is
  /// finished in its state.
  void take_reached_changes();
  /// True if another world, or a world of other regions, has begun. Throws SomebodyDied if all have to go back.
  bool change_if_due();

 private:
  void change_scene(const std::string& name);
  void change_world(const std::string& file);
  void change_regions(const std::vector<core::Rectangle>& boxes);
  void move_to_regions(const std::vector<core::Rectangle>& boxes);
  void begin_regions(const config::Launch& launch, core::Generation generation);
  void begin_anew();
  void wait_for_all_nodes();
  void settle_all();
  void connect_for_change(const dds::TransportSettings& settings);

  NodeRuntime& run_;
  CommandExecutor& executor_;
};

}  // namespace aurasim::process
