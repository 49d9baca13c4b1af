// Why a run cannot execute a command, as a message for the user: the command itself is not sound (steering/ask.h), or
// this run, in its present state, does not allow it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/launch.h"
#include "core/command.h"
#include "core/scene.h"

namespace aurasim::steering {

struct CommandContext {
  const config::Launch& launch;
  const core::Scene& scene;  ///< with all additions
  core::Step now = 0;
  std::uint64_t bodies = 0;          ///< in the whole run
  std::optional<core::Shape> shape;  ///< the command's own shape, if it has one
};

/// Why the command cannot be executed. Empty if it can.
std::string problem_with(const core::Command& command, const CommandContext& context);

}  // namespace aurasim::steering
