// One run of the scalability experiment (thesis section 5.1): which rain falls on which regions, under which rules.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/ids.h"
#include "lab/scale/layout.h"

namespace aurasim::lab {

struct Rain {
  std::string series;  ///< what the run is for; part of its name
  Layout regions;
  /// The regions that the injectors follow. The thesis's follow those of the run, so more servers have a larger world;
  /// with a layout of its own the world stays the same, and only its cuts differ.
  Layout world;
  std::string aura = "swept";
  double uncertainty = 0.5;  ///< U
  int lookahead = 0;         ///< K; 0: from the tolerances
  std::string solver = "soft_step";
  int substeps = 4;
  double rate_per_s = 160;
  double rain_s = 60;         ///< so long it rains
  double run_s = 60;          ///< so long it is watched
  double border_share = 0.5;  ///< of the bodies that fall near boundaries, the others in the middle of regions
  double fall_m_s = 10;       ///< top speed along each axis at birth
  double bandwidth_B_s = 0;   ///< of each node's link; 0: unlimited
  std::uint32_t repeat = 0;   ///< another one has other bodies

  std::uint64_t bodies() const { return static_cast<std::uint64_t>(rate_per_s * rain_s); }
  core::Step steps(double step_s) const;
  /// Unlike that of any other run: a file name.
  std::string name() const;
  /// What makes this run of launch_configs/columns_rain.yaml, as given to --set.
  std::vector<std::string> overrides() const;
};

}  // namespace aurasim::lab
