// Each run of the scalability experiment in a few numbers.
#pragma once

#include <vector>

#include "lab/scale/window.h"

namespace aurasim::lab {

/// Figures of one run. Counts are of the whole run.
struct RainFigures : Counts {
  double frame_max_ms = 0;          ///< longest frame of any node in any step
  double frame_p95_ms = 0;          ///< largest 95th percentile of the slowest node's frames, over all windows
  double growth_per_body = 0;       ///< slope of log10(largest frame of each window) over bodies (thesis 5.1.4)
  double overhead_share = 0;        ///< protocol and transport over physics, last window
  std::size_t largest_cluster = 0;  ///< of any step
  double most_hosted_share = 0;     ///< largest share of the bodies on one node at the end of a window, times the nodes
  Window last;
};

RainFigures figures_of(const std::vector<Window>& windows, std::size_t nodes);

}  // namespace aurasim::lab
