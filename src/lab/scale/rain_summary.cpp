#include "lab/scale/rain_summary.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <tuple>

#include "lab/scale/fit.h"
#include "lab/scale/scalability.h"

namespace aurasim::lab {
namespace {

using nlohmann::json;

/// Thesis section 5.1.4: ratio of the fitted coefficients.
const std::map<std::size_t, double> kThesisSpeedUp = {{2, 1.74}, {4, 3.40}, {8, 4.22}};

json json_of(const Rain& rain, const RainFigures& f) {
  return {{"series", rain.series},
          {"nodes", rain.regions.count},
          {"regions", rain.regions.name()},
          {"world", rain.world.name()},
          {"aura", rain.aura},
          {"uncertainty", rain.uncertainty},
          {"lookahead", rain.lookahead},
          {"solver", rain.solver},
          {"substeps", rain.substeps},
          {"rate_per_s", rain.rate_per_s},
          {"border_share", rain.border_share},
          {"repeat", rain.repeat},
          {"frame_max_ms", f.frame_max_ms},
          {"frame_p95_ms", f.frame_p95_ms},
          {"last_frame_ms", f.last_frame_ms},
          {"growth_per_body", f.growth_per_body},
          {"physics_ms", f.physics_ms},
          {"protocol_ms", f.protocol_ms},
          {"transport_ms", f.transport_ms},
          {"watch_ms", f.watch_ms},
          {"cut_ms", f.cut_ms},
          {"hash_ms", f.hash_ms},
          {"overhead_share", f.overhead_share},
          {"hand_offs", f.hand_offs},
          {"returns", f.returns},
          {"fall_m_s", rain.fall_m_s},
          {"bandwidth_B_s", rain.bandwidth_B_s},
          {"steps", rain.steps(1.0 / 60)},
          {"aura_updates", f.aura_updates},
          {"aura_bytes", f.aura_bytes},
          {"hand_off_bytes", f.hand_off_bytes},
          {"link_bytes", f.link_bytes},
          {"datagrams", f.datagrams},
          {"slow_down", f.slow_down},
          {"bodies", f.bodies},
          {"awake", f.awake},
          {"projecting", f.projecting},
          {"largest_cluster", f.largest_cluster},
          {"most_hosted_share", f.most_hosted_share},
          {"violations", f.violations},
          {"late", f.late}};
}

json spread(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {{"median", median(values)}, {"least", *least}, {"most", *most}};
}

/// A run and the one-node run of the same series, world and repeat.
struct Compared {
  std::vector<double> by_max, by_p95, by_last, fitted;
};

json speed_ups(const std::vector<std::pair<Rain, RainFigures>>& runs) {
  std::map<std::tuple<std::string, std::string, std::size_t>, Compared> groups;
  for (const auto& [rain, f] : runs) {
    if (rain.regions.count == 1 || (rain.series != "columns" && rain.series != "cuts")) continue;
    const auto central = std::find_if(runs.begin(), runs.end(), [&](const auto& run) {
      return run.first.regions.count == 1 && run.first.series == rain.series && run.first.repeat == rain.repeat;
    });
    if (central == runs.end()) continue;
    const RainFigures& one = central->second;
    Compared& group = groups[{rain.series, rain.aura, rain.regions.count}];
    group.by_max.push_back(one.frame_max_ms / f.frame_max_ms);
    group.by_p95.push_back(one.frame_p95_ms / f.frame_p95_ms);
    group.by_last.push_back(one.last_frame_ms / f.last_frame_ms);
    group.fitted.push_back(one.growth_per_body / f.growth_per_body);
  }
  json all = json::array();
  for (const auto& [key, group] : groups) {
    const auto& [series, aura, nodes] = key;
    json row = {{"series", series},
                {"aura", aura},
                {"nodes", nodes},
                {"repeats", group.by_max.size()},
                {"frame_max", spread(group.by_max)},
                {"frame_p95", spread(group.by_p95)},
                {"last_frame", spread(group.by_last)},
                {"fitted", spread(group.fitted)}};
    if (const auto thesis = kThesisSpeedUp.find(nodes); thesis != kThesisSpeedUp.end()) row["thesis"] = thesis->second;
    all.push_back(std::move(row));
  }
  return all;
}

}  // namespace

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
    f.late += w.mean.late;
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
  f.watch_ms = n * last.mean.watch_ms;
  f.cut_ms = n * last.mean.cut_ms;
  f.hash_ms = n * last.mean.hash_ms;
  f.overhead_share = (f.protocol_ms + f.transport_ms) / f.physics_ms;
  f.bodies = last.mean.bodies;
  f.awake = last.mean.awake;
  f.projecting = last.mean.projecting;
  return f;
}

json summarise_rains(const std::vector<Rain>& rains, const std::filesystem::path& directory) {
  std::vector<std::pair<Rain, RainFigures>> runs;
  json rows = json::array();
  for (const Rain& rain : rains) {
    const std::filesystem::path file = windows_file(directory, rain);
    if (!std::filesystem::exists(file)) continue;
    runs.emplace_back(rain, figures_of(read_windows(file), rain.regions.count));
    rows.push_back(json_of(rain, runs.back().second));
    rows.back()["windows"] = std::filesystem::relative(file, directory).string();
  }
  const json summary = {{"unit", "ms of CPU time per node and step"}, {"runs", rows}, {"speed_up", speed_ups(runs)}};
  std::ofstream(directory / "summary.json") << summary.dump(1) << '\n';
  return summary;
}

}  // namespace aurasim::lab
