#include "lab/scale/rain_summary.h"

#include <algorithm>

#include "lab/scale/fit.h"

namespace aurasim::lab {

RainFigures figures_of(const std::vector<Window>& windows, std::size_t nodes) {
  RainFigures f;
  if (windows.empty()) return f;
  std::vector<double> bodies, frames;
  for (const Window& w : windows) {
    const auto in_all = static_cast<double>(w.bodies);
    bodies.push_back(in_all);
    frames.push_back(w.frame_max_ms);
    f += w;
    f.frame_max_ms = std::max(f.frame_max_ms, w.frame_max_ms);
    f.frame_p95_ms = std::max(f.frame_p95_ms, w.frame_p95_ms);
    f.largest_cluster = std::max(f.largest_cluster, w.largest_cluster);
    if (w.bodies > 0) f.most_hosted_share = std::max(f.most_hosted_share, double(w.most_hosted * nodes) / in_all);
  }
  f.growth_per_body = fitted_growth(bodies, frames).slope;
  f.last = windows.back();
  f.overhead_share = (f.last.protocol_ms + f.last.transport_ms) / f.last.physics_ms;
  return f;
}

}  // namespace aurasim::lab
