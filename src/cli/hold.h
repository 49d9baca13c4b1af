// In which state a node of a paused run stands. No clock, no DDS.
#pragma once

#include <optional>

#include "dds/control_messages.h"

namespace aurasim::cli {

/// After a pause, a step or a resume; `holds_at` was before. Nothing: it does not stand. A step goes to the state that
/// it names: who followed the others there, before it heard of the step, goes no farther.
std::optional<core::Step> holds_at_after(const dds::RunCommand& command, std::optional<core::Step> holds_at);

/// Of a step: what is due at its `epoch_ns`.
core::Step first_state_of(const dds::RunCommand& step);

}  // namespace aurasim::cli
