#include "lab/scale/rain_run.h"

#include <cmath>

#include "lab/scale/round_trips.h"

namespace aurasim::lab {
namespace {

constexpr double kMs = 1e3;
/// In virtual time frames are never late, so the run measures work and not waiting.
constexpr double kFrame_s = 0.001;
constexpr double kLatency_s = 0.0005;

/// What a node has counted since the start.
struct Counted {
  std::uint64_t auras = 0;
  std::uint64_t violations = 0;
  std::uint64_t late = 0;
  Traffic traffic;
};

Counted counts_of(const VirtualCluster& cluster, std::size_t region) {
  const node::Node& node = cluster.node(region);
  const core::ProjectionCounters& auras = node.protocol().projection().counters();
  return {auras.created + auras.updated + auras.deleted, node.protocol().violations().total(),
          node.collision_watch().late() + node.collision_watch().missed(),
          cluster.post().traffic(core::RegionId{static_cast<std::uint32_t>(region)})};
}

StepLoad load_of(const node::StepReport& report, const Counted& before, const Counted& now, RoundTrips& trips) {
  StepLoad load;
  load.physics_ms = kMs * report.durations.physics_s;
  load.protocol_ms = kMs * report.durations.protocol_s;
  load.transport_ms = kMs * report.durations.transport_s;
  load.other_ms = kMs * (report.durations.watch_s + report.durations.cut_s + report.durations.hash_s);
  load.bodies = report.bodies;
  load.projecting = report.projecting;
  load.largest_cluster = report.largest_cluster;
  for (const node::HandOffRow& row : report.departures) {
    ++load.departures;
    load.returns += trips.add(row.body, row.source, row.destination, row.stamp);
  }
  load.aura_updates = now.auras - before.auras;
  load.aura_bytes = now.traffic.aura_bytes - before.traffic.aura_bytes;
  load.hand_off_bytes = now.traffic.hand_off_bytes - before.traffic.hand_off_bytes;
  load.link_bytes = now.traffic.link_bytes - before.traffic.link_bytes;
  load.datagrams = now.traffic.datagrams - before.traffic.datagrams;
  load.violations = now.violations - before.violations;
  load.late = now.late - before.late;
  return load;
}

}  // namespace

ClusterRules rules_of(const Rain& rain, const config::Launch& launch, const RainPlace& place) {
  ClusterRules rules = launch_rules(launch, place.setup_of);
  rules.clock = node::PhaseClock::kThreadCpu;
  rules.network.latency_s = kLatency_s;
  rules.shortest_frame_s = rules.longest_frame_s = kFrame_s;
  rules.bandwidth_B_s = rain.bandwidth_B_s > 0 ? rain.bandwidth_B_s : kUnlimited_B_s;
  return rules;
}

std::optional<std::vector<Window>> run_rain(const Rain& rain, const RainPlace& place,
                                            const std::function<void(double)>& stepped, const std::atomic<bool>& stop) {
  const config::Launch launch = config::read_launch(place.launch_file, rain.overrides());
  const double step_s = launch.step_s();
  const core::Step steps = rain.steps(step_s);
  VirtualCluster cluster(launch.scene, launch.regions, rules_of(rain, launch, place));
  WindowSums sums(cluster.size(), std::llround(kWindow_s / step_s));
  std::vector<Counted> counts(cluster.size());
  RoundTrips trips(std::llround(1 / step_s));
  for (core::Step shown = 0; cluster.slowest() < steps;) {
    const VirtualCluster::Event event = cluster.next();
    const std::size_t region = core::value_of(event.region);
    const Counted now = counts_of(cluster, region);
    sums.add(region, event.report->step, load_of(*event.report, counts[region], now, trips));
    counts[region] = now;
    if (cluster.slowest() < shown + 20) continue;
    shown = cluster.slowest();
    stepped(static_cast<double>(shown) / static_cast<double>(steps));
    if (stop) return std::nullopt;
  }
  std::vector<Window> windows = sums.windows();
  for (Window& window : windows) window.slow_down = cluster.slow_down();
  return windows;
}

}  // namespace aurasim::lab
