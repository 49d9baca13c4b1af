#include "experiment/scale/window.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "node/csv.h"
#include "node/durations.h"

namespace aurasim::experiment {
namespace {

constexpr const char* kHeader =
    "region,begin_s,slow_down,frame_max_ms,frame_p95_ms,frame_mean_ms,physics_ms,protocol_ms,transport_ms,watch_ms,"
    "bodies,awake,"
    "projecting,foreign,largest_cluster,departures,returns,aura_updates,aura_bytes,hand_off_bytes,link_bytes,datagrams,"
    "violations,late";
constexpr std::size_t kColumns = 24;

void add_times(StepLoad& sum, const StepLoad& load, double weight) {
  sum.physics_ms += weight * load.physics_ms;
  sum.protocol_ms += weight * load.protocol_ms;
  sum.transport_ms += weight * load.transport_ms;
  sum.watch_ms += weight * load.watch_ms;
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
  window.frame_p95_ms = node::percentile(frames, 0.95);
}

}  // namespace

void WindowSums::add(std::size_t region, core::Step step, const StepLoad& load) {
  auto& loads = loads_.at(region);
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

void write_windows(const std::filesystem::path& file, const std::vector<Window>& windows) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::trunc);
  out << kHeader << '\n';
  for (const Window& w : windows) {
    const StepLoad& m = w.mean;
    out << fmt::format("{},{:g},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},", w.region, w.begin_s,
                       w.slow_down, w.frame_max_ms, w.frame_p95_ms, w.frame_mean_ms, m.physics_ms, m.protocol_ms,
                       m.transport_ms, m.watch_ms)
        << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", m.bodies, m.awake, m.projecting, m.foreign,
                       m.largest_cluster, m.departures, m.returns, m.aura_updates, m.aura_bytes, m.hand_off_bytes,
                       m.link_bytes, m.datagrams, m.violations, m.late);
  }
  out.close();
  if (!out) throw std::runtime_error(fmt::format("cannot write {}", part.string()));
  std::filesystem::rename(part, file);  // a file that is there is whole
}

std::vector<Window> read_windows(const std::filesystem::path& file) {
  std::vector<Window> windows;
  node::read_csv(file, [&](const std::vector<std::string_view>& cells) {
    if (cells.size() != kColumns) throw std::runtime_error(fmt::format("{}: a row is broken", file.string()));
    Window& w = windows.emplace_back();
    StepLoad& m = w.mean;
    std::size_t i = 0;
    w.region = static_cast<int>(node::number(cells[i++]));
    for (double* to : {&w.begin_s, &w.slow_down, &w.frame_max_ms, &w.frame_p95_ms, &w.frame_mean_ms, &m.physics_ms,
                       &m.protocol_ms, &m.transport_ms, &m.watch_ms}) {
      *to = node::number(cells[i++]);
    }
    for (std::size_t* to : {&m.bodies, &m.awake, &m.projecting, &m.foreign, &m.largest_cluster}) {
      *to = node::whole(cells[i++]);
    }
    for (std::uint64_t* to : {&m.departures, &m.returns, &m.aura_updates, &m.aura_bytes, &m.hand_off_bytes,
                              &m.link_bytes, &m.datagrams, &m.violations, &m.late}) {
      *to = node::whole(cells[i++]);
    }
  });
  return windows;
}

}  // namespace aurasim::experiment
