// To which state do all go back when a node has died? No clock, no DDS: from what the nodes say of themselves.
#pragma once

#include <map>
#include <optional>

#include "dds/control_messages.h"

namespace aurasim::cli {

struct RestorePlan {
  core::RegionId lead{};      ///< whose node says so to the others
  dds::RunCommand command{};  ///< kRestore, without the times
};

/// Nothing as long as a region has nobody, somebody still computes, or somebody does not hear all others. The state is
/// the newest whose parts are all there, or the first one of the scene (RunCommand::count is 1 then).
std::optional<RestorePlan> plan_restore(const std::map<core::RegionId, dds::SeenStatus>& nodes, std::size_t regions);

}  // namespace aurasim::cli
