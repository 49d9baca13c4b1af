#include "lab/scale/many_nodes.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <malloc.h>

namespace aurasim::lab {
namespace {

constexpr double kCell_m = 80;
/// States from the newest cut to a death.
constexpr core::Step kSinceCut = 20;

double memory_in_use() { return static_cast<double>(mallinfo2().uordblks); }

Rain rain_of(const ManyNodes& many) {
  Rain rain;
  rain.series = "many";
  rain.regions = rain.world = {Layout::Kind::kGrid, many.nodes(), kCell_m};
  rain.run_s = rain.rain_s = many.run_s;
  rain.rate_per_s = many.bodies_per_node * static_cast<double>(many.nodes()) / many.run_s;
  return rain;
}

/// The work of all nodes together.
struct Sums {
  double physics_s = 0, protocol_s = 0, transport_s = 0;
  std::uint64_t steps = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t messages = 0, bytes = 0;

  void add(const node::StepReport& report) {
    physics_s += report.durations.physics_s;
    protocol_s += report.durations.protocol_s;
    transport_s += report.durations.transport_s;
    ++steps;
  }
};

/// The cluster, the sums of the states after `first`, and the hash of the last state.
class ManyNodesRun {
 public:
  ManyNodesRun(const config::Launch& launch, const ClusterRules& rules, core::Step first, core::Step last,
               const core::WorldCut* world)
      : first_(first),
        last_(last),
        cluster_(launch.scene, launch.regions, rules, world,
                 world != nullptr ? node::Recorded::kYes : node::Recorded::kNo) {}

  /// Computes until all nodes have confirmed this state. False if `shown` returned false.
  bool run_until(core::Step state, const std::function<bool(double)>& shown) {
    for (core::Step told = 0; cluster_.slowest() < state || cluster_.confirmed() < state;) {
      const VirtualCluster::Event event = cluster_.next();
      note(event);
      if (event.region != core::RegionId{0} || event.report->step < told + 10) continue;
      told = event.report->step;
      if (!shown(static_cast<double>(told) / static_cast<double>(last_))) return false;
    }
    return true;
  }

  VirtualCluster& cluster() { return cluster_; }
  const Sums& sums() const { return sums_; }
  std::uint64_t hash() const { return hash_; }
  std::vector<core::WorldCut>& saved() { return saved_; }

 private:
  void note(const VirtualCluster::Event& event) {
    const std::size_t region = core::value_of(event.region);
    node::Node& node = cluster_.node(region);
    if (event.report->step > first_) sums_.add(*event.report);
    if (event.report->step == first_) begin_[event.region] = cluster_.post().traffic(event.region);
    // Coupled nodes have all computed a state before the first of them tells of it.
    const bool is_first = event.region == core::RegionId{0};
    if (is_first && event.report->step == first_) parcels_ = cluster_.parcels();
    if (is_first && event.report->step == last_) {
      sums_.messages += cluster_.parcels().count - parcels_.count;
      sums_.bytes += cluster_.parcels().bytes - parcels_.bytes;
    }
    if (event.report->step == last_) {
      const Traffic& now = cluster_.post().traffic(event.region);
      sums_.messages += now.messages - begin_[event.region].messages;
      sums_.bytes += now.link_bytes - begin_[event.region].link_bytes;
    }
    for (core::WorldCut& part : node.take_saved()) saved_.push_back(std::move(part));
    for (const node::StepReport& report : node.confirmed()) {
      if (report.step > first_) sums_.hand_offs += report.departures.size();
      for (const node::HashPart& part : report.hash) {
        if (part.step == last_) hash_ += part.sum;
      }
    }
  }

  core::Step first_, last_;
  VirtualCluster cluster_;
  Sums sums_;
  std::uint64_t hash_ = 0;
  std::map<core::RegionId, Traffic> begin_;
  transport::ParcelCount parcels_;  ///< after state `first_`
  std::vector<core::WorldCut> saved_;
};

/// The world that the others go on from when nodes die after `half`; nothing if `shown` returned false.
std::optional<core::WorldCut> world_after_deaths(const ManyNodes& many, const config::Launch& launch,
                                                 const ClusterRules& rules, core::Step half,
                                                 const std::function<bool(double)>& shown) {
  ManyNodesRun run(launch, rules, half, 2 * half, nullptr);
  for (std::size_t r = 0; r < many.nodes(); ++r) run.cluster().node(r).save(half - kSinceCut);
  if (!run.run_until(half, shown)) return std::nullopt;
  for (std::size_t i = 0; i < many.deaths; ++i) {
    run.cluster().stop(core::RegionId{static_cast<std::uint32_t>(i * many.nodes() / many.deaths)});
  }
  return core::merge(std::move(run.saved()));
}

}  // namespace

std::optional<NodeCosts> measure_many_nodes(const ManyNodes& many, const RainPlace& place,
                                            const std::function<bool(double)>& shown) {
  const Rain rain = rain_of(many);
  std::vector<std::string> settings = rain.overrides();
  settings.emplace_back("time.sync=deterministic");
  if (many.coupled) settings.insert(settings.end(), {"exchange=coupled", "time.lookahead=1"});
  const config::Launch launch = config::read_launch(place.launch_file, settings);
  ClusterRules rules = rules_of(rain, launch, place);
  rules.hash_states = true;
  const core::Step last = rain.steps(launch.step_s());
  std::optional<core::WorldCut> world;
  if (many.deaths > 0) {
    world = world_after_deaths(many, launch, rules, last / 2, shown);
    if (!world) return std::nullopt;
  }
  const double before = memory_in_use();
  ManyNodesRun run(launch, rules, last / 2, last, world ? &*world : nullptr);
  if (!run.run_until(last + 4 * launch.lookahead() + 2, shown)) return std::nullopt;
  const Sums& sums = run.sums();
  const auto nodes = static_cast<double>(many.nodes());
  const double node_steps = nodes * static_cast<double>(last - last / 2);
  NodeCosts costs;
  costs.messages = static_cast<double>(sums.messages) / node_steps;
  costs.bytes = static_cast<double>(sums.bytes) / node_steps;
  const auto us = [&](double seconds) {
    return 1e6 * seconds / static_cast<double>(std::max<std::uint64_t>(1, sums.steps));
  };
  costs.physics_us = us(sums.physics_s), costs.protocol_us = us(sums.protocol_s),
  costs.transport_us = us(sums.transport_s);
  costs.memory_kB = (memory_in_use() - before) / nodes / 1e3;
  for (std::size_t r = 0; r < many.nodes(); ++r)
    costs.bodies += static_cast<double>(run.cluster().node(r).report().bodies) / nodes;
  costs.hand_offs = static_cast<double>(sums.hand_offs) / nodes / (many.run_s / 2);
  costs.hash = run.hash();
  costs.redos = run.cluster().node(0).redos();
  return costs;
}

}  // namespace aurasim::lab
