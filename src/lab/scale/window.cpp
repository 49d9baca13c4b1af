#include "lab/scale/window.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "records/durations.h"

namespace aurasim::lab {
namespace {

void add_times(StepLoad& sum, const StepLoad& load, double weight) {
  sum.physics_ms += weight * load.physics_ms;
  sum.protocol_ms += weight * load.protocol_ms;
  sum.transport_ms += weight * load.transport_ms;
  sum.watch_ms += weight * load.watch_ms;
  sum.cut_ms += weight * load.cut_ms;
  sum.hash_ms += weight * load.hash_ms;
}

void add_counts(StepLoad& sum, const StepLoad& load) {
  sum.departures += load.departures;
  sum.returns += load.returns;
  sum.aura_updates += load.aura_updates;
  sum.aura_bytes += load.aura_bytes;
  sum.hand_off_bytes += load.hand_off_bytes;
  sum.link_bytes += load.link_bytes;
  sum.datagrams += load.datagrams;
  sum.violations += load.violations;
  sum.late += load.late;
}

void add_numbers(StepLoad& sum, const StepLoad& load) {
  sum.bodies += load.bodies;
  sum.awake += load.awake;
  sum.projecting += load.projecting;
  sum.foreign += load.foreign;
}

void describe_frames(std::vector<double> frames, Window& window) {
  window.frame_max_ms = *std::max_element(frames.begin(), frames.end());
  double sum = 0;
  for (const double frame : frames) sum += frame;
  window.frame_mean_ms = sum / static_cast<double>(frames.size());
  window.frame_p95_ms = records::percentile(frames, 0.95);
}

}  // namespace

void WindowSums::add(std::size_t region, core::Step step, const StepLoad& load) {
  auto& loads = loads_.at(region);
  if (step <= static_cast<core::Step>(loads.size())) {
    if (step > 0) add_counts(loads[static_cast<std::size_t>(step) - 1], load);
    return;
  }
  if (step != static_cast<core::Step>(loads.size()) + 1) throw std::logic_error("a step is missing");
  loads.push_back(load);
}

Window WindowSums::of_region(std::size_t region, std::size_t first, std::size_t last) const {
  Window window;
  window.region = static_cast<int>(region);
  std::vector<double> frames;
  for (const StepLoad& load : std::span(loads_[region]).subspan(first, last - first)) {
    frames.push_back(load.frame_ms());
    add_times(window.mean, load, 1 / static_cast<double>(last - first));
    add_counts(window.mean, load);
    window.mean.largest_cluster = std::max(window.mean.largest_cluster, load.largest_cluster);
  }
  add_numbers(window.mean, loads_[region][last - 1]);
  describe_frames(std::move(frames), window);
  return window;
}

Window WindowSums::of_all(std::size_t first, std::size_t last) const {
  Window window;
  std::vector<double> slowest(last - first, 0);
  for (std::size_t r = 0; r < regions_; ++r) {
    for (std::size_t i = first; i < last; ++i) {
      slowest[i - first] = std::max(slowest[i - first], loads_[r][i].frame_ms());
    }
    const Window one = of_region(r, first, last);
    add_times(window.mean, one.mean, 1 / static_cast<double>(regions_));
    add_counts(window.mean, one.mean);
    add_numbers(window.mean, one.mean);
    window.mean.largest_cluster = std::max(window.mean.largest_cluster, one.mean.largest_cluster);
  }
  describe_frames(std::move(slowest), window);
  return window;
}

std::vector<Window> WindowSums::windows() const {
  std::size_t steps = loads_.empty() ? 0 : loads_[0].size();
  for (const auto& loads : loads_) steps = std::min(steps, loads.size());
  std::vector<Window> windows;
  const auto length = static_cast<std::size_t>(steps_per_window_);
  for (std::size_t first = 0; first + length <= steps; first += length) {
    for (std::size_t r = 0; r < regions_; ++r) windows.push_back(of_region(r, first, first + length));
    windows.push_back(of_all(first, first + length));
    for (std::size_t r = 0; r <= regions_; ++r) {
      windows[windows.size() - 1 - r].begin_s = static_cast<double>(first) * step_s_;
    }
  }
  return windows;
}

}  // namespace aurasim::lab
