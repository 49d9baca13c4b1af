// Command-line options for the length of a run.
#pragma once

#include <optional>

#include <CLI/CLI.hpp>

#include "config/launch.h"

namespace aurasim::setup {

struct RunLength {
  core::Step steps = -1;
  double duration_s = -1;

  /// Adds --steps and --duration.
  void add_to(CLI::App& command);
  /// The last state of a run that begins with state `first`. Nothing if the run goes on until a stop command.
  std::optional<core::Step> last_step(const config::Launch& launch, core::Step first = 0) const;
};

}  // namespace aurasim::setup
