// To which earlier state does a run go back when somebody asks for it? No clock, no DDS: from what the nodes say that
// they keep.
#pragma once

#include <map>
#include <optional>

#include "dds/control_messages.h"

namespace aurasim::cli {

/// The newest state not later than `latest` of which every region's node keeps its own part, as the command (kRestore)
/// that takes all back to it, without the times. Orders given since are forgotten: nobody is asked for them. Nothing if
/// there is none, or if a node is missing or does something else.
std::optional<dds::RunCommand> plan_step_back(const std::map<core::RegionId, dds::SeenStatus>& nodes,
                                              std::size_t regions, core::Step latest);

}  // namespace aurasim::cli
