#include "setup/run_length.h"

#include <cmath>

namespace aurasim::setup {

void RunLength::add_to(CLI::App& command) {
  CLI::Option* by_steps = command.add_option("--steps", steps, "stop after this state")
                              ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 40));
  command.add_option("--duration", duration_s, "stop after so many simulated seconds")
      ->check(CLI::Range(0.0, 1e9))
      ->excludes(by_steps);
}

std::optional<core::Step> RunLength::last_step(const config::Launch& launch, core::Step first) const {
  if (steps >= 0) return steps;
  if (duration_s >= 0) return first + std::llround(duration_s * launch.time.step_hz);
  return std::nullopt;
}

}  // namespace aurasim::setup
