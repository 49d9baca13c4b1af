// Why a command cannot be done, in words for the person who asked. The numbers are those of core/limits.h and of the
// run.
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
  const core::Scene& scene;  ///< as it has grown
  core::Step now = 0;
  std::uint64_t bodies = 0;          ///< in the whole run
  std::optional<core::Shape> shape;  ///< what the command's own shape comes to, if it has one
};

/// Empty: it can be done.
std::string problem_with(const core::Command& command, const CommandContext& context);
/// Rays are answered by all regions, without a context.
std::string problem_with(const core::Ray& ray);

}  // namespace aurasim::cli
