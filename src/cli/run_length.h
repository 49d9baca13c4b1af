// How long a run goes, as the command line says it.
#pragma once

#include <optional>

#include <CLI/CLI.hpp>

#include "config/launch.h"

namespace aurasim::cli {

struct RunLength {
  core::Step steps = -1;
  double duration_s = -1;

  /// --steps or --duration.
  void add_to(CLI::App& command);
  /// The last state of a run that begins with `first`; nothing: until told to stop.
  std::optional<core::Step> last_step(const config::Launch& launch, core::Step first = 0) const;
};

}  // namespace aurasim::cli
