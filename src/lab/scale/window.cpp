#include "lab/scale/window.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "records/durations.h"

namespace aurasim::lab {

Counts& Counts::operator+=(const Counts& other) {
  departures += other.departures;
  returns += other.returns;
  aura_updates += other.aura_updates;
  aura_bytes += other.aura_bytes;
  hand_off_bytes += other.hand_off_bytes;
  link_bytes += other.link_bytes;
  datagrams += other.datagrams;
  violations += other.violations;
  late += other.late;
  return *this;
}

void WindowSums::add(std::size_t region, core::Step step, const StepLoad& load) {
  auto& loads = loads_.at(region);
  if (step <= static_cast<core::Step>(loads.size())) {
    if (step > 0) loads[static_cast<std::size_t>(step) - 1] += load;
    return;
  }
  if (step != static_cast<core::Step>(loads.size()) + 1) throw std::logic_error("a step is missing");
  loads.push_back(load);
}

Window WindowSums::window_from(std::size_t first) const {
  const auto steps = static_cast<double>(steps_per_window_);
  Window window;
  std::vector<double> slowest(steps_per_window_, 0);
  for (const std::vector<StepLoad>& loads : loads_) {
    for (std::size_t i = 0; i < steps_per_window_; ++i) {
      const StepLoad& load = loads[first + i];
      slowest[i] = std::max(slowest[i], load.frame_ms());
      window.physics_ms += load.physics_ms / steps;
      window.protocol_ms += load.protocol_ms / steps;
      window.transport_ms += load.transport_ms / steps;
      window.largest_cluster = std::max(window.largest_cluster, load.largest_cluster);
      window += load;
    }
    const StepLoad& last = loads[first + steps_per_window_ - 1];
    window.bodies += last.bodies;
    window.projecting += last.projecting;
    window.most_hosted = std::max(window.most_hosted, last.bodies);
  }
  window.frame_max_ms = *std::ranges::max_element(slowest);
  window.frame_mean_ms = std::accumulate(slowest.begin(), slowest.end(), 0.0) / steps;
  window.frame_p95_ms = records::percentile(slowest, 0.95);
  return window;
}

std::vector<Window> WindowSums::windows() const {
  std::size_t steps = std::numeric_limits<std::size_t>::max();
  for (const auto& loads : loads_) steps = std::min(steps, loads.size());
  std::vector<Window> windows;
  for (std::size_t first = 0; first + steps_per_window_ <= steps; first += steps_per_window_) {
    windows.push_back(window_from(first));
  }
  return windows;
}

}  // namespace aurasim::lab
