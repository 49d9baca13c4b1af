#include "lab/scenes/world_trial.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "core/violation.h"
#include "core/world_cut.h"
#include "lab/conditions.h"
#include "lab/scenes/deaths.h"
#include "lab/scenes/interference.h"
#include "lab/scenes/play.h"
#include "lab/scenes/world_files.h"
#include "physics/region_world.h"

namespace aurasim::lab {
namespace {

/// Sets delays so that frame and message together take less than K steps and no node waits for long. On a bad network
/// some do.
void set_network(ClusterRules& rules, bool bad, std::uint64_t seed) {
  const double step_s = rules.aura.step_s, whole_s = step_s * rules.aura.lookahead;
  rules.seed = seed;
  rules.shortest_frame_s = 0.1 * std::min(step_s, rules.aura.frame_s);
  rules.longest_frame_s = 0.9 * std::min(step_s, rules.aura.frame_s);
  rules.network.latency_s = bad ? 0.3 * whole_s : 0.1 * step_s;
  if (!bad) return;
  rules.network.jitter_s = 0.5 * whole_s;
  rules.network.loss = 0.1;
  rules.network.resend_after_s = 0.02;
  rules.network.duplicate = 0.05;
  rules.network.keep_order = seed % 2 == 0;
}

/// Adds partitions of the network. Each has some nodes on one side, and all others on the other.
void add_partitions(ClusterRules& rules, std::size_t regions, core::Step steps, std::uint64_t seed) {
  constexpr int kPartitions = 3;
  constexpr double kLongest_s = 2;
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double to) { return to * static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int i = 0; i < kPartitions; ++i) {
    const double from_s = uniform(static_cast<double>(steps) * rules.aura.step_s),
                 until_s = from_s + uniform(kLongest_s);
    const std::uint64_t side = 1 + random() % ((std::uint64_t{1} << regions) - 2);  // at least one node, and not all
    for (std::uint32_t a = 0; a < regions; ++a) {
      for (std::uint32_t b = a + 1; b < regions; ++b) {
        if ((side >> a & 1) == (side >> b & 1)) continue;
        rules.broken_links.push_back({core::RegionId{a}, core::RegionId{b}, from_s, until_s});
      }
    }
  }
}

void count_faults(const VirtualCluster& cluster, WorldOutcome& outcome) {
  for (std::size_t r = 0; r < cluster.size(); ++r) {
    const node::CollisionWatch& watch = cluster.node(r).collision_watch();
    outcome.late += watch.late();
    outcome.missed += watch.missed();
    outcome.unflagged += watch.unflagged();
    for (const core::Refusal& refusal : cluster.node(r).protocol().intake().refusals()) {
      outcome.error = fmt::format("region {} refuses a message of region {} for state {}: {}", r,
                                  core::value_of(refusal.source), refusal.stamp, refusal.why);
    }
  }
  outcome.violations = cluster.violations();
  outcome.speed = cluster.violations(core::ViolationKind::kSpeed);
  outcome.latency = cluster.violations(core::ViolationKind::kLatency);
  outcome.promise = cluster.violations(core::ViolationKind::kPromise);
  outcome.span = cluster.violations(core::ViolationKind::kSpan);
}

/// A map for `nodes` nodes over the area of `like`, as near to a square grid as possible.
core::RegionMap map_of(int nodes, const core::RegionMap& like) {
  const core::Rectangle first = like.region(core::RegionId{0});
  const double cell_m = std::clamp(std::min(first.x1 - first.x0, first.y1 - first.y0), 4.0, 30.0);
  auto rows = static_cast<std::size_t>(std::sqrt(nodes));
  while (static_cast<std::size_t>(nodes) % rows != 0) --rows;
  return core::RegionMap::grid(rows, static_cast<std::size_t>(nodes) / rows, cell_m, cell_m);
}

/// Checks that a saved world goes on with the same bits. False when `stop` became true.
bool compare_loaded(const config::Launch& launch, const ClusterRules& cluster_rules, const core::WorldCut& world,
                    const std::vector<std::uint64_t>& wanted, const Interference& given, const TrialRules& rules,
                    const std::atomic<bool>& stop, WorldOutcome& outcome) {
  for (const int nodes : rules.load_on) {
    Interference interference = given;
    VirtualCluster cluster(launch.scene, map_of(nodes, launch.regions), cluster_rules, &world);
    const auto loaded = play(cluster, interference, rules.steps, launch.lookahead(), stop, nullptr, &world);
    if (!loaded) return false;
    const auto from = static_cast<std::ptrdiff_t>(world.step);
    const auto first = std::mismatch(wanted.begin() + from, wanted.end(), loaded->hash.begin() + from).first;
    if (first == wanted.end()) continue;
    outcome.error = fmt::format("saved in state {} and loaded on {} nodes, state {} differs", world.step, nodes,
                                first - wanted.begin());
    return true;
  }
  return true;
}

/// Compares the run on the map's regions with that on one node. False when `stop` became true.
bool compare_runs(const config::Launch& launch, Interference interference, const TrialRules& rules, std::uint64_t seed,
                  const std::atomic<bool>& stop, WorldOutcome& outcome) {
  ClusterRules cluster_rules = launch_rules(launch, rules.setup_of);
  cluster_rules.hash_states = true;
  cluster_rules.bandwidth_B_s = kUnlimited_B_s;  // coded as for DDS, but not held up
  set_network(cluster_rules, rules.bad_network, seed);
  ClusterRules loaded_rules = cluster_rules;  // on other regions
  if (rules.partitions) add_partitions(cluster_rules, launch.regions.size(), rules.steps, seed);
  const int lookahead = launch.lookahead();
  std::optional<VirtualCluster> regions;
  std::optional<Saver> saver;
  if (rules.save_at) saver.emplace(*rules.save_at);
  std::optional<Played> many;
  if (rules.deaths > 0) {
    const Disasters disasters{rules.deaths, rules.steps, seed};
    many = play_with_deaths(disasters, launch, cluster_rules, interference, stop, regions);
  } else {
    regions.emplace(launch.scene, launch.regions, cluster_rules);
    many = play(*regions, interference, rules.steps, lookahead, stop, saver ? &*saver : nullptr);
  }
  if (!many) return false;
  count_faults(*regions, outcome);
  outcome.hand_offs = many->hand_offs;
  outcome.largest_cluster = many->largest_cluster;
  outcome.regions_s = many->cpu_s;
  outcome.redos = many->redos;
  outcome.computed_again = many->again;
  if (saver && !compare_loaded(launch, loaded_rules, saver->take(regions->size()), many->hash, interference, rules,
                               stop, outcome)) {
    return false;
  }
  ClusterRules single_rules = std::move(loaded_rules);
  single_rules.aura.redo = false;
  single_rules.coupled = false;
  single_rules.bandwidth_B_s.reset();
  VirtualCluster single(launch.scene, core::RegionMap::columns(1, 1), single_rules);
  const auto one = play(single, interference, rules.steps, launch.lookahead(), stop);
  if (!one) return false;
  outcome.unflagged_on_one = single.node(0).collision_watch().unflagged();
  outcome.broken = one->broken;
  outcome.first_fault = one->first_fault;
  outcome.bodies = one->bodies;
  outcome.one_s = one->cpu_s;
  const auto first = std::ranges::mismatch(many->hash, one->hash).in1;
  if (first != many->hash.end()) outcome.first_difference = first - many->hash.begin();
  return true;
}

}  // namespace

std::optional<WorldOutcome> run_world(const std::filesystem::path& directory, const TrialRules& rules,
                                      std::uint64_t seed, const std::atomic<bool>& stop) {
  std::vector<std::string> overrides = {std::string("time.sync=").append(name_of(rules.sync))};
  overrides.insert(overrides.end(), rules.overrides.begin(), rules.overrides.end());
  const config::Launch launch = config::read_launch(directory / kLaunchFile, overrides);
  const Interference interference = read_interference(directory / kInterferenceFile, launch.scene);
  WorldOutcome outcome;
  outcome.regions = launch.regions.size();
  try {
    if (!compare_runs(launch, interference, rules, seed, stop, outcome)) return std::nullopt;
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  return outcome;
}

}  // namespace aurasim::lab
