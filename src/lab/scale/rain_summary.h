// Each run of the scalability experiment in a few numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/scale/window.h"

namespace aurasim::lab {

/// Figures of one run.
struct RainFigures {
  double frame_max_ms = 0;     ///< longest frame of any node in any step
  double frame_p95_ms = 0;     ///< largest 95th percentile of the slowest node's frames, over all windows
  double last_frame_ms = 0;    ///< mean of the slowest node in the last window
  double growth_per_body = 0;  ///< slope of log10(largest frame of each window) over bodies (thesis 5.1.4)
  double physics_ms = 0;       ///< means of the last window, summed over nodes
  double protocol_ms = 0;
  double transport_ms = 0;
  double overhead_share = 0;    ///< protocol and transport over physics, last window
  std::uint64_t hand_offs = 0;  ///< bodies
  std::uint64_t returns = 0;    ///< hand-offs that bring a body back within a second
  std::uint64_t aura_updates = 0;
  std::uint64_t aura_bytes = 0, hand_off_bytes = 0, link_bytes = 0, datagrams = 0;
  double slow_down = 1;
  std::size_t bodies = 0, projecting = 0;  ///< in the last step
  std::size_t largest_cluster = 0;         ///< of any step
  double most_hosted_share = 0;  ///< largest share of the bodies on one node at the end of a window, times the nodes
  std::uint64_t violations = 0;
};

RainFigures figures_of(const std::vector<Window>& windows, std::size_t nodes);

}  // namespace aurasim::lab
