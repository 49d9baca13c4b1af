#include "cluster/checked_run.h"

#include <algorithm>

#include "cluster/scenes.h"
#include "core/horizon.h"
#include "records/setpoint_record.h"
#include "records/thrashing.h"

namespace aurasim::test {
namespace {

using core::BodyId;
using core::RegionId;
using core::Step;

lab::ClusterRules rules_of(const ClusterOptions& options) {
  lab::ClusterRules rules = options;
  rules.physics.foresight_s =
      rules.aura.step_s * core::horizon::announcing(rules.aura.lookahead, core::horizon::kMostHops);
  rules.physics.top_speed_m_s = rules.aura.top_speed_m_s;
  for (std::uint32_t r = 0; options.cut && r < options.map.size(); ++r) {
    if (RegionId{r} == options.cut->region) continue;
    rules.broken_links.push_back({options.cut->region, RegionId{r}, options.cut->from_s, options.cut->until_s});
  }
  return rules;
}

/// Calls `visit` for each body that the node hosts, or has handed over and not been told of its arrival.
template <class Visit>
void for_each_body_of(node::Node& node, const Visit& visit) {
  for (const core::BodyState& body : node.world().snapshot().bodies) visit(body.id);
  for (const core::HandOff& open : node.protocol().departures().open()) {
    for (const core::BodyRecord& body : open.cluster.bodies) visit(body.id);
  }
}

}  // namespace

ClusterOptions checked_options(int seed) {
  ClusterOptions options;
  options.sync = core::SyncMode::kDeterministic;
  options.seed = static_cast<std::uint64_t>(seed);
  options.aura.top_speed_m_s = 40;
  options.aura.redo = true;
  options.physics.block_m = block_of(seed);
  options.bandwidth_B_s = lab::kUnlimited_B_s;
  options.network.latency_s = 0.004 * (seed % 7);
  options.network.jitter_s = 0.006 * (seed % 4);
  options.network.keep_order = seed % 2 == 0;
  return options;
}

CheckedRun::CheckedRun(const core::Scene& scene, const ClusterOptions& options)
    : options_(options), cluster_(scene, options.map, rules_of(options)) {}

template <class Visit>
void CheckedRun::for_each_live(const Visit& visit) {
  for (std::uint32_t r = 0; r < cluster_.size(); ++r) {
    if (cluster_.is_alive(r)) visit(cluster_.node(r));
  }
}

Outcome CheckedRun::run(Step steps) {
  outcome_ = {};
  outcome_.hash.assign(static_cast<std::size_t>(steps) + 1, 0);
  std::uint64_t request = 0;
  for (const auto& [step, action] : options_.orders) cluster_.node(0).order(action, ++request, step);
  for (std::uint32_t r = 0; r < cluster_.size(); ++r) {
    take_reports(r);
    if (on_state) on_state(cluster_.node(r), cluster_.node(r).report(), 0);
  }
  if (!options_.aura.redo) cluster_.end_in(steps);
  while (!has_done(steps)) take(cluster_.next());
  for (std::uint32_t r = 1; r < cluster_.size(); ++r) cluster_.end_in(RegionId{r}, steps + options_.overrun);
  while (options_.overrun > 0) {
    const std::optional<lab::VirtualCluster::Event> event = cluster_.try_next();
    if (!event) break;
    take(*event);
  }
  settle();
  for (std::uint32_t r = 0; r < cluster_.size(); ++r) {
    for (const node::StepReport& report : cluster_.node(r).finish(steps)) take_report(RegionId{r}, report);
  }
  account();
  return outcome_;
}

bool CheckedRun::has_done(Step steps) const {
  return cluster_.slowest() >= steps && (!options_.aura.redo || cluster_.confirmed() >= steps);
}

void CheckedRun::take(const lab::VirtualCluster::Event& event) {
  lab::note_redo(event, outcome_);
  const std::uint32_t r = core::value_of(event.region);
  take_reports(r);
  if (on_state) on_state(cluster_.node(r), *event.report, cluster_.now_s());
  if (!options_.aura.redo) check_single_host();  // else some may have gone back already
  end_who_is_held_for_dead();
  if (!options_.crash || !cluster_.is_alive(r) || event.region != options_.crash->region) return;
  if (event.report->step < options_.crash->step) return;
  end(event.region);
  cluster_.crash(event.region, options_.crash->lease_s);
}

void CheckedRun::take_reports(std::uint32_t region) {
  for (const node::StepReport& report : cluster_.node(region).confirmed()) take_report(RegionId{region}, report);
}

void CheckedRun::take_report(RegionId region, const node::StepReport& report) {
  lab::note_report(report, outcome_);
  for (const node::SeenCollision& seen : report.collisions) {
    if (!seen.missed) outcome_.contacts.push_back(seen.collision);
    if (seen.late || seen.missed) outcome_.wrong.push_back({region, seen});
  }
  const auto note_effects = [this](const auto& effects) {
    for (const auto& effect : effects) outcome_.effects.push_back(records::as_heard_again(effect));
  };
  note_effects(report.effects.bodies);
  note_effects(report.effects.statics);
  note_effects(report.effects.joints);
  for (const physics::Removal& removal : report.removals) {
    removed_.insert(removal.body);
    if (!removal.fault.empty()) outcome_.broken_bodies.push_back(removal);
  }
  outcome_.applied += report.applied.size();
  moves.insert(moves.end(), report.departures.begin(), report.departures.end());
  for (const node::HandOffRow& row : report.departures) {
    const auto [before, first] = last_departure_.try_emplace(row.body, row);
    if (first) continue;
    outcome_.thrashed += records::is_thrashing(before->second, row);
    before->second = row;
  }
}

/// On every step each body has at most one host.
void CheckedRun::check_single_host() {
  std::set<BodyId> hosted;
  for_each_live([&](node::Node& node) {
    for (const core::BodyState& body : node.world().snapshot().bodies) {
      seen_.insert(body.id);
      if (!hosted.insert(body.id).second) doubled_.insert(body.id);
    }
  });
}

void CheckedRun::end_who_is_held_for_dead() {
  for (std::uint32_t r = 0; r < cluster_.size(); ++r) {
    for (const RegionId dead : cluster_.node(r).protocol().intake().dead_regions()) {
      if (cluster_.is_alive(core::value_of(dead))) end(dead);
    }
  }
}

void CheckedRun::end(RegionId region) {
  cluster_.stop(region);
  outcome_.dead.push_back(region);
  for_each_body_of(cluster_.node(core::value_of(region)), [this](BodyId id) { with_dead_.insert(id); });
}

/// Every message that is under way arrives; nothing new is published.
void CheckedRun::settle() {
  if (options_.aura.redo) return;
  cluster_.deliver_all();
  for_each_live([this](node::Node& node) {
    node.ready_to_settle();
    take_report(node.region(), node.settle());
  });
  check_single_host();
}

void CheckedRun::account() {
  std::set<BodyId> found;
  for_each_live([&](node::Node& node) {
    for_each_body_of(node, [&found](BodyId id) { found.insert(id); });
    outcome_.late += node.collision_watch().late();
    outcome_.missed += node.collision_watch().missed();
    outcome_.unflagged += node.collision_watch().unflagged();
    outcome_.violations += node.protocol().violations().total();
    outcome_.late_words += node.protocol().violations().count(core::ViolationKind::kLatency);
    outcome_.severed += node.world().severed_contacts();
    outcome_.bad_phases += node.protocol().projection().counters().bad_phase_changes;
  });
  outcome_.doubled = doubled_.size();
  outcome_.removed = removed_.size();
  for (const BodyId id : seen_) {
    if (found.contains(id) || removed_.contains(id)) continue;
    ++(with_dead_.contains(id) ? outcome_.with_dead : outcome_.lost);
  }
}

Step first_difference(const lab::Played& a, const lab::Played& b) {
  return std::ranges::mismatch(a.hash, b.hash).in1 - a.hash.begin();
}

Outcome run_central(const core::Scene& scene, ClusterOptions options, Step steps) {
  options.map = core::RegionMap::columns(1, 1);
  options.crash.reset();
  options.cut.reset();
  return CheckedRun(scene, options).run(steps);
}

}  // namespace aurasim::test
