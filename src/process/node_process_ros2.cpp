// How a node publishes to ROS 2, if the launch file says so (ros2_link.h).
#include <algorithm>

#include "process/node_process.h"

namespace aurasim::process {

void NodeProcess::open_ros2() {
  if (launch_.ros2.on && !ros2_) ros2_.emplace(launch_, options_.region);
}

/// Publishes to ROS 2 between two states. The live node of the lowest region also publishes the time.
void NodeProcess::tell_ros2() {
  if (!ros2_) return;
  const bool leads = std::ranges::none_of(control_.statuses(), [this](const auto& entry) {
    return entry.first < options_.region && entry.second.is_live();
  });
  ros2_->tell(*node_, generation_, leads);
}

}  // namespace aurasim::process
