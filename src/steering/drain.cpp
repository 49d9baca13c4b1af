#include "steering/drain.h"

#include <algorithm>

#include <fmt/format.h>

#include "steering/run_steering.h"

namespace aurasim::steering {

Draining::Draining(dds::ControlBus& control, core::RegionId region) : control_(control), region_(region) {
  const auto node = control.statuses().find(region);
  if (node == control.statuses().end() || !node->second.is_live()) {
    throw SteeringRefused(fmt::format("there is no region {}", core::value_of(region)));
  }
  leaving_ = node->second.status.process;
  control.send(about_process(messages::RunCommandKind::kDrain, node->second.status.run, region, leaving_));
}

const messages::Status* Draining::successor() {
  const auto computes = [](const auto& entry) {
    const messages::NodeState state = entry.second.status.state;
    return state == messages::NodeState::kRunning || state == messages::NodeState::kPaused;
  };
  const auto& statuses = control_.statuses();
  const messages::Status& status = statuses.at(region_).status;
  return status.process != leaving_ && std::ranges::all_of(statuses, computes) ? &status : nullptr;
}

}  // namespace aurasim::steering
