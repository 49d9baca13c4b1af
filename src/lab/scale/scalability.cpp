#include "lab/scale/scalability.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "lab/on_threads.h"

namespace aurasim::lab {
namespace {

using Clock = std::chrono::steady_clock;

Layout columns(std::size_t count, double width_m = 80) { return {Layout::Kind::kColumns, count, width_m}; }

Rain begin(const ScalabilityPlan& plan, const std::string& series, const Layout& regions, const Layout& world) {
  Rain rain;
  rain.series = series;
  rain.regions = regions;
  rain.world = world;
  rain.rate_per_s = plan.rate_per_s;
  rain.rain_s = rain.run_s = plan.run_s;
  rain.solver = plan.solver;
  rain.substeps = plan.substeps;
  rain.lookahead = regions.count > 1 ? plan.lookahead : 0;
  return rain;
}

/// Adds the same rain with every aura. One node needs no aura, so it runs once.
void add_with_auras(const ScalabilityPlan& plan, Rain rain, std::vector<Rain>& out) {
  for (const std::string& aura : plan.auras) {
    rain.aura = aura;
    if (rain.regions.count > 1 || aura == plan.auras.front()) out.push_back(rain);
  }
}

void add_series(const ScalabilityPlan& plan, const std::string& series, std::vector<Rain>& out) {
  if (series == "columns") {
    for (const std::size_t n : plan.columns) add_with_auras(plan, begin(plan, series, columns(n), columns(n)), out);
  } else if (series == "corners") {
    using Kind = Layout::Kind;
    for (const Layout& layout :
         {Layout{Kind::kCorner, 3, 80}, Layout{Kind::kGrid, 4, 80}, Layout{Kind::kGrid, 9, 80}}) {
      out.push_back(begin(plan, series, layout, layout));
    }
  } else if (series == "cuts") {
    for (const std::size_t n : {1, 2, 4, 8}) {
      add_with_auras(plan, begin(plan, series, columns(n, 640.0 / static_cast<double>(n)), columns(8)), out);
    }
  } else if (series == "weak") {
    for (const std::size_t n : {1, 2, 4, 8}) {
      out.push_back(begin(plan, series, columns(n), columns(n)));
      out.back().rate_per_s = plan.rate_per_s / 8 * static_cast<double>(n);
    }
  } else if (series == "border") {
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      out.push_back(begin(plan, series, columns(2), columns(2)));
      out.back().border_share = share;
    }
  } else if (series == "asleep") {
    out.push_back(begin(plan, series, columns(2), columns(2)));
    out.back().rain_s = plan.run_s / 2;
  } else if (series == "uncertainty") {
    for (const double u : {0.0, 0.25, 0.5, 1.0, 2.0}) {
      out.push_back(begin(plan, series, columns(4), columns(4)));
      out.back().uncertainty = u;
    }
  } else if (series == "speed") {
    for (const double fall_m_s : {2.5, 5.0, 10.0, 15.0}) {
      Rain rain = begin(plan, series, columns(2), columns(2));
      rain.fall_m_s = fall_m_s;
      rain.border_share = 1;
      add_with_auras(plan, rain, out);
    }
  } else if (series == "link") {
    for (const double bandwidth_B_s : {12.5e6, 2e6, 1e6, 5e5, 2.5e5, 1e5, 5e4}) {
      Rain rain = begin(plan, series, columns(2), columns(2));
      rain.bandwidth_B_s = bandwidth_B_s;
      rain.border_share = 1;
      add_with_auras(plan, rain, out);
    }
  } else if (series == "lookahead") {
    for (const int k : {1, 2}) {
      out.push_back(begin(plan, series, columns(4), columns(4)));
      out.back().lookahead = k;
    }
  }
}

/// Estimated work: bodies times steps, and a constant for each step of each node.
double work_of(const Rain& rain) {
  return rain.run_s * (static_cast<double>(rain.bodies()) + 100 * static_cast<double>(rain.regions.count));
}

/// Hands runs to threads and adds up the work done.
class Queue {
 public:
  Queue(std::vector<Rain> rains, const std::function<void(const Progress&)>& show)
      : rains_(std::move(rains)), shares_(rains_.size(), 0), begin_(Clock::now()), show_(show) {
    for (const Rain& rain : rains_) all_ += work_of(rain);
  }

  const Rain* take(std::size_t& index) {
    const std::lock_guard lock(mutex_);
    index = next_++;
    return index < rains_.size() ? &rains_[index] : nullptr;
  }

  void done(std::size_t index, double share) {
    const std::lock_guard lock(mutex_);
    shares_[index] = share;
    double sum = 0;
    for (std::size_t i = 0; i < rains_.size(); ++i) sum += shares_[i] * work_of(rains_[i]);
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    show_({sum / all_, elapsed_s, sum > 0 ? elapsed_s * (all_ - sum) / sum : 0});
  }

 private:
  std::mutex mutex_;
  std::vector<Rain> rains_;
  std::vector<double> shares_;
  std::size_t next_ = 0;
  double all_ = 0;
  Clock::time_point begin_;
  const std::function<void(const Progress&)>& show_;
};

void work(Queue& queue, const RainPlace& place, const std::filesystem::path& directory, const std::atomic<bool>& stop) {
  std::size_t index = 0;
  while (const Rain* rain = stop ? nullptr : queue.take(index)) {
    const auto result = run_rain(
        *rain, place, [&](double share) { queue.done(index, share); }, stop);
    if (result) write_windows(windows_file(directory, *rain), *result);
  }
}

}  // namespace

std::vector<std::string> scalability_series() {
  return {"columns", "corners", "cuts", "weak", "border", "asleep", "uncertainty", "lookahead"};
}

std::vector<std::string> bandwidth_series() { return {"speed", "link"}; }

std::vector<Rain> rains_of(const ScalabilityPlan& plan) {
  std::vector<Rain> rains;
  for (std::uint32_t repeat = 0; repeat < plan.repeats; ++repeat) {
    const std::size_t first = rains.size();
    for (const std::string& series : plan.series) add_series(plan, series, rains);
    for (std::size_t i = first; i < rains.size(); ++i) rains[i].repeat = repeat;
  }
  return rains;
}

std::filesystem::path windows_file(const std::filesystem::path& directory, const Rain& rain) {
  return directory / "runs" / (rain.name() + ".csv");
}

bool run_rains(const std::vector<Rain>& rains, const RainPlace& place, const std::filesystem::path& directory,
               int threads, const std::function<void(const Progress&)>& show, const std::atomic<bool>& stop) {
  std::filesystem::create_directories(directory / "runs");
  std::vector<Rain> missing;
  for (const Rain& rain : rains) {
    if (!std::filesystem::exists(windows_file(directory, rain))) missing.push_back(rain);
  }
  Queue queue(std::move(missing), show);
  on_threads(threads, [&] { work(queue, place, directory, stop); });
  return !stop;
}

}  // namespace aurasim::lab
