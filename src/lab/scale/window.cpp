#include "lab/scale/window.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "records/csv.h"
#include "records/durations.h"

namespace aurasim::lab {
namespace {

/// A window as it is in a file.
struct WindowRow : Window {
  template <class Value>
  static constexpr auto mean_of(std::string_view name, Value StepLoad::*member, std::string_view format = "{}") {
    return records::Column{name, [member](auto& row) -> auto& {return row.mean.*member;
  }
  , format
};
}  // namespace

static constexpr auto columns() {
  constexpr std::string_view kTime = "{:.4f}";
  return std::tuple{records::Column{"region", &WindowRow::region},
                    records::Column{"begin_s", &WindowRow::begin_s, "{:g}"},
                    records::Column{"slow_down", &WindowRow::slow_down, kTime},
                    records::Column{"frame_max_ms", &WindowRow::frame_max_ms, kTime},
                    records::Column{"frame_p95_ms", &WindowRow::frame_p95_ms, kTime},
                    records::Column{"frame_mean_ms", &WindowRow::frame_mean_ms, kTime},
                    mean_of("physics_ms", &StepLoad::physics_ms, kTime),
                    mean_of("protocol_ms", &StepLoad::protocol_ms, kTime),
                    mean_of("transport_ms", &StepLoad::transport_ms, kTime),
                    mean_of("watch_ms", &StepLoad::watch_ms, kTime),
                    mean_of("cut_ms", &StepLoad::cut_ms, kTime),
                    mean_of("hash_ms", &StepLoad::hash_ms, kTime),
                    mean_of("bodies", &StepLoad::bodies),
                    mean_of("awake", &StepLoad::awake),
                    mean_of("projecting", &StepLoad::projecting),
                    mean_of("foreign", &StepLoad::foreign),
                    mean_of("largest_cluster", &StepLoad::largest_cluster),
                    mean_of("departures", &StepLoad::departures),
                    mean_of("returns", &StepLoad::returns),
                    mean_of("aura_updates", &StepLoad::aura_updates),
                    mean_of("aura_bytes", &StepLoad::aura_bytes),
                    mean_of("hand_off_bytes", &StepLoad::hand_off_bytes),
                    mean_of("link_bytes", &StepLoad::link_bytes),
                    mean_of("datagrams", &StepLoad::datagrams),
                    mean_of("violations", &StepLoad::violations),
                    mean_of("late", &StepLoad::late)};
}
};  // namespace aurasim::lab

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

void write_windows(const std::filesystem::path& file, const std::vector<Window>& windows) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::trunc);
  out << records::csv_header<WindowRow>();
  for (const Window& window : windows) out << records::csv_line(WindowRow{window});
  out.close();
  if (!out) throw std::runtime_error(fmt::format("cannot write {}", part.string()));
  std::filesystem::rename(part, file);  // renamed when complete, so an existing file is whole
}

std::vector<Window> read_windows(const std::filesystem::path& file) {
  std::vector<Window> windows;
  const std::size_t broken = records::read_csv<WindowRow>(file, [&](const WindowRow& row) { windows.push_back(row); });
  if (broken > 0) throw std::runtime_error(fmt::format("{}: {} broken rows", file.string(), broken));
  return windows;
}

}  // namespace aurasim::lab
