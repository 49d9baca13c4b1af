#include "lab/scale/rain_summary.h"

#include <algorithm>

#include "lab/scale/fit.h"

namespace aurasim::lab {
RainFigures figures_of(const std::vector<Window>& windows, std::size_t nodes) {
  RainFigures f;
  std::vector<double> bodies, frames;
  std::size_t in_all = 0;
  std::size_t most_hosted = 0;
  for (const Window& w : windows) {
    if (w.region >= 0) {
      most_hosted = std::max(most_hosted, w.mean.bodies);
      continue;
    }
    in_all = w.mean.bodies;
    bodies.push_back(static_cast<double>(in_all));
    frames.push_back(w.frame_max_ms);
    f.frame_max_ms = std::max(f.frame_max_ms, w.frame_max_ms);
    f.frame_p95_ms = std::max(f.frame_p95_ms, w.frame_p95_ms);
    f.hand_offs += w.mean.departures;
    f.returns += w.mean.returns;
    f.aura_updates += w.mean.aura_updates;
    f.aura_bytes += w.mean.aura_bytes;
    f.hand_off_bytes += w.mean.hand_off_bytes;
    f.link_bytes += w.mean.link_bytes;
    f.datagrams += w.mean.datagrams;
    f.largest_cluster = std::max(f.largest_cluster, w.mean.largest_cluster);
    f.violations += w.mean.violations;
    if (in_all > 0) {
      f.most_hosted_share =
          std::max(f.most_hosted_share, static_cast<double>(most_hosted * nodes) / static_cast<double>(in_all));
    }
    most_hosted = 0;
  }
  if (frames.empty()) return f;
  const Window& last = *std::find_if(windows.rbegin(), windows.rend(), [](const Window& w) { return w.region < 0; });
  const auto n = static_cast<double>(nodes);
  f.last_frame_ms = last.frame_mean_ms;
  f.slow_down = last.slow_down;
  f.growth_per_body = fitted_growth(bodies, frames).slope;
  f.physics_ms = n * last.mean.physics_ms;
  f.protocol_ms = n * last.mean.protocol_ms;
  f.transport_ms = n * last.mean.transport_ms;
  f.overhead_share = (f.protocol_ms + f.transport_ms) / f.physics_ms;
  f.bodies = last.mean.bodies;
  f.projecting = last.mean.projecting;
  return f;
}

}  // namespace aurasim::lab
