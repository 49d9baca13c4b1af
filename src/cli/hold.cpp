#include "cli/hold.h"

#include <algorithm>

namespace aurasim::cli {

std::optional<core::Step> holds_at_after(const dds::RunCommand& command, std::optional<core::Step> holds_at) {
  using Kind = dds::RunCommandKind;
  if (command.kind == Kind::kPause) return command.at_step;
  if (command.kind == Kind::kResume) return std::nullopt;
  if (command.kind == Kind::kStep && holds_at) return std::max(*holds_at, command.at_step);
  return holds_at;
}

core::Step first_state_of(const dds::RunCommand& step) { return step.at_step - step.count + 1; }

}  // namespace aurasim::cli
