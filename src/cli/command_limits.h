// Why a command cannot be done, in words for the person who asked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/launch.h"
#include "core/command.h"
#include "core/scene.h"

namespace aurasim::cli {

struct CommandContext {
  const config::Launch& launch;
  const core::Scene& scene;          ///< as it has grown
  std::uint64_t bodies = 0;          ///< in the whole run
  std::optional<core::Shape> shape;  ///< what the command's own shape comes to, if it has one
};

/// Empty: it can be done.
std::string problem_with(const core::Ask& ask, const CommandContext& context);

}  // namespace aurasim::cli
