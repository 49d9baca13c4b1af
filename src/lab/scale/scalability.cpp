#include "lab/scale/scalability.h"

#include <utility>

namespace aurasim::lab {
namespace {

Layout columns(std::size_t count, double width_m = 80) { return {Layout::Kind::kColumns, count, width_m}; }

Rain begin(const ScalabilityPlan& plan, const std::string& series, const Layout& regions, const Layout& world) {
  Rain rain;
  rain.series = series;
  rain.regions = regions;
  rain.world = world;
  rain.rain_s = rain.run_s = plan.run_s;
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
      out.back().rate_per_s *= static_cast<double>(n) / 8;
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

std::optional<std::vector<std::vector<Window>>> run_rains(const std::vector<Rain>& rains, const RainPlace& place,
                                                          int threads, const Progress& progress) {
  std::vector<double> costs;
  for (const Rain& rain : rains) costs.push_back(work_of(rain));
  std::vector<std::vector<Window>> windows(rains.size());
  const bool finished = on_threads(threads, costs, progress, [&](const WorkPiece& piece) {
    auto result = run_rain(rains[piece.index], place, piece.shown, piece.stop);
    if (result) windows[piece.index] = std::move(*result);
  });
  if (!finished) return std::nullopt;
  return windows;
}

}  // namespace aurasim::lab
