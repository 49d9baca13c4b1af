// One run of the scalability experiment (thesis section 5.1): a rain of bodies on regions, with the rules of the nodes.
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
  /// The layout that the injectors follow. In the thesis it is the run's own, so more nodes have a larger world. With a
  /// fixed layout the world stays the same and only the regions differ.
  Layout world;
  std::string aura = "swept";
  double uncertainty = 0.5;  ///< U
  int lookahead = 0;         ///< K; 0: from the tolerances
  double rate_per_s = 160;
  double rain_s = 60;         ///< how long it rains, simulated seconds
  double run_s = 60;          ///< length of the run, simulated seconds
  double border_share = 0.5;  ///< share of bodies that fall near boundaries; others fall in the middle
  double fall_m_s = 10;       ///< top speed along each axis at birth
  double bandwidth_B_s = 0;   ///< of each node's link; 0: unlimited
  std::uint32_t repeat = 0;   ///< each repeat has other random bodies

  std::uint64_t bodies() const { return static_cast<std::uint64_t>(rate_per_s * rain_s); }
  core::Step steps(double step_s) const;
  /// Unique name of the run, used as a file name.
  std::string name() const;
  /// Overrides for --set that turn launch_configs/columns_rain.yaml into this run.
  std::vector<std::string> overrides() const;
};

}  // namespace aurasim::lab
