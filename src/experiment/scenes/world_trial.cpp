#include "experiment/scenes/world_trial.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <time.h>

#include "core/violation.h"
#include "experiment/conditions.h"
#include "experiment/scenes/interference.h"
#include "experiment/scenes/world_files.h"
#include "physics/region_world.h"

namespace aurasim::experiment {
namespace {

double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Frames and messages together take less than K steps, so that nobody waits for long; on a bad network some do.
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

/// One run of a world.
struct Played {
  std::vector<std::uint64_t> hash;  ///< by state
  std::uint64_t hand_offs = 0;
  std::uint64_t broken = 0;
  std::string first_fault;
  std::size_t largest_cluster = 0;
  std::size_t bodies = 0;
  double cpu_s = 0;
  std::uint64_t redos = 0;
  std::uint64_t again = 0;  ///< states computed once more
};

void note_report(const node::StepReport& report, Played& played) {
  for (const node::HashPart& part : report.hash) {
    if (part.step < static_cast<core::Step>(played.hash.size())) {
      played.hash[static_cast<std::size_t>(part.step)] += part.sum;
    }
  }
  played.hand_offs += report.departures.size();
  played.largest_cluster = std::max(played.largest_cluster, report.largest_cluster);
  for (const physics::Removal& removal : report.removals) {
    if (removal.fault.empty()) continue;
    if (played.broken++ > 0) continue;
    played.first_fault =
        fmt::format("body {} in state {}: {}", core::value_of(removal.body), removal.step, removal.fault);
  }
}

/// State 0, and what comes after it. Nothing when `stop` became true.
std::optional<Played> play(VirtualCluster& cluster, std::vector<Request>& requests, core::Step steps, int lookahead,
                           const std::atomic<bool>& stop) {
  const core::Step more = 4 * lookahead + 2;  // by then, whoever was under way has arrived
  Played played;
  played.hash.assign(static_cast<std::size_t>(steps) + 1, 0);
  const double begin_s = thread_time_s();
  const auto note_reports = [&](std::span<const node::StepReport> reports) {
    for (const node::StepReport& report : reports) note_report(report, played);
  };
  for (std::size_t r = 0; r < cluster.size(); ++r) note_reports(cluster.node(r).confirmed());
  ImpatientClient client(requests);
  while (cluster.slowest() < steps + more || cluster.confirmed() < steps) {
    if (stop) return std::nullopt;
    client.speak(cluster.node(0));
    const VirtualCluster::Event event = cluster.next();
    note_reports(cluster.node(core::value_of(event.region)).confirmed());
    if (!event.report->put_back_from || event.region != core::RegionId{0}) continue;
    ++played.redos;
    played.again += static_cast<std::uint64_t>(*event.report->put_back_from - event.report->step);
  }
  for (std::size_t r = 0; r < cluster.size(); ++r) note_reports(cluster.node(r).finish(steps + more));
  for (std::size_t r = 0; r < cluster.size(); ++r) played.bodies += cluster.node(r).report().bodies;
  played.cpu_s = thread_time_s() - begin_s;
  return played;
}

void count_faults(const VirtualCluster& cluster, WorldOutcome& outcome) {
  for (std::size_t r = 0; r < cluster.size(); ++r) {
    const node::CollisionWatch& watch = cluster.node(r).collision_watch();
    outcome.late += watch.late();
    outcome.missed += watch.missed();
    outcome.unflagged += watch.unflagged();
  }
  outcome.violations = cluster.violations();
  outcome.speed = cluster.violations(core::ViolationKind::kSpeed);
  outcome.latency = cluster.violations(core::ViolationKind::kLatency);
  outcome.promise = cluster.violations(core::ViolationKind::kPromise);
  outcome.span = cluster.violations(core::ViolationKind::kSpan);
}

/// False when `stop` became true.
bool compare_runs(const config::Launch& launch, Interference interference, const TrialRules& rules, std::uint64_t seed,
                  const std::atomic<bool>& stop, WorldOutcome& outcome) {
  ClusterRules cluster_rules = launch_rules(launch, rules.setup_of);
  cluster_rules.hash_states = true;
  cluster_rules.bandwidth_B_s = std::numeric_limits<double>::infinity();  // coded as for DDS, but not held up
  cluster_rules.shuffle_ranks_steps = interference.shuffle_ranks_steps;
  set_network(cluster_rules, rules.bad_network, seed);
  VirtualCluster regions(launch.scene, launch.regions, cluster_rules);
  const auto many = play(regions, interference.requests, rules.steps, launch.lookahead(), stop);
  if (!many) return false;
  count_faults(regions, outcome);
  outcome.hand_offs = many->hand_offs;
  outcome.largest_cluster = many->largest_cluster;
  outcome.regions_s = many->cpu_s;
  outcome.redos = many->redos;
  outcome.computed_again = many->again;
  cluster_rules.aura.redo = false;
  cluster_rules.bandwidth_B_s.reset();
  VirtualCluster single(launch.scene, core::RegionMap::columns(1, 1), cluster_rules);
  const auto one = play(single, interference.requests, rules.steps, launch.lookahead(), stop);
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
  if (launch.physics.precision != physics::RegionWorld::precision()) {
    throw std::runtime_error(fmt::format("{} says precision {}, and this program computes in {}", launch.file.string(),
                                         launch.physics.precision, physics::RegionWorld::precision()));
  }
  const Interference interference = read_interference(directory / kInterferenceFile, launch.scene);
  // Bullet's Dantzig solver keeps its error flag in a variable of the process: two at a time spoil each other.
  static std::mutex dantzig_mutex;
  std::unique_lock<std::mutex> only_one;
  if (launch.physics.solver == "dantzig") only_one = std::unique_lock(dantzig_mutex);
  WorldOutcome outcome;
  outcome.regions = launch.regions.size();
  try {
    if (!compare_runs(launch, interference, rules, seed, stop, outcome)) return std::nullopt;
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  return outcome;
}

}  // namespace aurasim::experiment
