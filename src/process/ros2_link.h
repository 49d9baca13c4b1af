// Publishes a node's bodies and joints to ROS 2 and turns messages from ROS 2 into setpoints (dds/ros2_bus.h,
// docs/ros2.md).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "config/launch.h"
#include "core/setpoint.h"
#include "dds/ros2_bus.h"
#include "node/node.h"
#include "process/held_back.h"
#include "process/ros2_view.h"

namespace aurasim::process {

class Ros2Link {
 public:
  /// `launch` must outlive the link and is the run's present launch: its scene may change with the generation.
  Ros2Link(const config::Launch& launch, core::RegionId region);

  /// Publishes what is due of the states that are certain, and in a paused run sends the present one to readers that
  /// have just come. May be called as often as wanted between two states. `leads`: this node also publishes the time.
  void publish(node::Node& node, core::Generation generation, bool leads);
  /// To be called when the run goes back to state `step`. Later states that have not been published yet are published
  /// when they have been computed again.
  void put_back(core::Step step, core::Step confirmed);
  /// Messages received since the last call, as setpoints that name no state.
  std::vector<core::Setpoints> take(core::Generation generation);
  std::uint64_t refused() const { return bus_.refused(); }

 private:
  bool is_due(core::Step step);
  void begin(core::Generation generation);
  std::vector<dds::Ros2Transform> transforms_of(const core::Snapshot& snapshot) const;

  const config::Launch& launch_;
  dds::Ros2Bus bus_;
  core::Step tick_steps_;
  std::optional<core::Generation> generation_;  ///< generation that names_ and joints_ belong to
  std::optional<FrameNames> names_;
  std::optional<JointRows> joints_;
  HeldBack held_;
  core::Step next_ = 0;  ///< the next state that is due
  core::Step published_ = -1;
  std::uint64_t arrivals_ = 0;
  std::optional<std::chrono::steady_clock::time_point> somebody_came_at_;  ///< when a reader last came
};

}  // namespace aurasim::process
