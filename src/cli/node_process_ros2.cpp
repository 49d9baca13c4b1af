// What a node has to do with ROS 2, where the launch file says so (ros2_link.h).
#include <algorithm>

#include "cli/node_process.h"

namespace aurasim::cli {

void NodeProcess::open_ros2() {
  if (launch_.ros2.on && !ros2_) ros2_.emplace(launch_, options_.region);
}

/// Between two states. The live node of the lowest region says what time it is.
void NodeProcess::tell_ros2() {
  if (!ros2_) return;
  const bool leads = std::ranges::none_of(control_.statuses(), [this](const auto& entry) {
    return entry.first < options_.region && entry.second.is_live();
  });
  ros2_->tell(*node_, generation_, leads);
}

}  // namespace aurasim::cli
