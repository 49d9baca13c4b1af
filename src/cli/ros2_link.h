// When a node process says what to ROS 2, and what it makes of what it hears (dds/ros2_bus.h). docs/ros2.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "cli/ros2_view.h"
#include "config/launch.h"
#include "core/setpoint.h"
#include "dds/ros2_bus.h"
#include "node/node.h"

namespace aurasim::cli {

class Ros2Link {
 public:
  /// `launch` outlives it, and is the one that the run goes by: its scene may change with the generation.
  Ros2Link(const config::Launch& launch, core::RegionId region);

  /// As often as you like between two states: what is due of the newest one, and in a run that stands, what has just
  /// begun to listen. `leads`: this node says what time it is.
  void tell(node::Node& node, core::Generation generation, bool leads);
  /// What has been heard since the last call, as setpoints that name no state.
  std::vector<core::Setpoints> take(core::Generation generation);
  std::uint64_t refused() const { return bus_.refused(); }

 private:
  bool is_due(core::Step step);
  void begin(core::Generation generation);
  void tell_bodies(const core::Snapshot& snapshot, dds::Ros2Time now);

  const config::Launch& launch_;
  dds::Ros2Bus bus_;
  core::Step tick_steps_;
  std::optional<core::Generation> generation_;  ///< whose names these are
  std::optional<FrameNames> names_;
  std::optional<JointRows> joints_;
  std::vector<dds::Ros2Transform> transforms_;  ///< reused
  core::Step next_ = 0;                         ///< the next state that is due
  std::uint64_t arrivals_ = 0;
  std::optional<std::chrono::steady_clock::time_point> somebody_came_at_;  ///< and may have missed it
};

}  // namespace aurasim::cli
