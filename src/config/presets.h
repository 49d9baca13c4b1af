// Named choices between speed and accuracy: points on the front of `aurasim-lab run accuracy` (docs/accuracy.md
// says how they were chosen).
#pragma once

#include <array>
#include <string>

namespace aurasim::config {

struct Preset {
  const char* name;
  const char* solver;
  int iterations;
  int substeps;  ///< time.substeps
  int friction_directions;
};

inline constexpr std::array<Preset, 3> kPresets = {{
    {"fast", "soft_step", 10, 4, 2},
    {"balanced", "soft_step", 10, 8, 2},
    {"exact", "sequential_impulse", 50, 8, 2},
}};

/// Returns a preset. Throws std::invalid_argument if there is none of this name.
const Preset& preset_named(const std::string& name);

}  // namespace aurasim::config
