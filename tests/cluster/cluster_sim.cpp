#include "cluster/cluster_sim.h"

#include <algorithm>
#include <stdexcept>

#include "cluster/wire_check.h"
#include "core/horizon.h"
#include "records/setpoint_record.h"
#include "records/thrashing.h"

namespace aurasim::test {

using core::BodyId;
using core::RegionId;
using core::Step;

ClusterSim::ClusterSim(const core::Scene& scene, const ClusterOptions& options)
    : scene_(scene), options_(options), random_(options.seed * 0x9E3779B97F4A7C15ull + 1) {
  std::vector<std::vector<RegionId>> listeners;
  const auto regions = static_cast<std::uint32_t>(options_.map.size());
  for (std::uint32_t r = 0; r < regions; ++r) {
    listeners.push_back(options_.map.neighbours(RegionId{r}, options_.neighbour_distance_m));
  }
  network_ = std::make_unique<transport::MemoryNetwork>(listeners, options_.faults, options_.seed);
  if (options_.cut) cut_off(*options_.cut);
  for (std::uint32_t r = 0; r < regions; ++r) {
    node::NodeSetup setup;
    setup.protocol.self = RegionId{r};
    setup.protocol.sync = options_.sync;
    setup.protocol.aura = options_.aura;
    setup.protocol.neighbour_distance_m = options_.neighbour_distance_m;
    setup.protocol.shuffle_ranks_steps = options_.shuffle_ranks_steps;
    setup.physics.step_s = options_.aura.step_s;
    setup.physics.substeps = options_.aura.substeps;
    setup.physics.solver = options_.solver;
    setup.protocol.aura.looks_once = setup.physics.looks_once();
    setup.physics.foresight_s =
        setup.physics.step_s * core::horizon::announcing(options_.aura.lookahead, core::horizon::kMostHops);
    setup.recorded = options_.recorded;
    setup.physics.friction_directions = options_.friction_directions;
    setup.physics.solver_iterations = options_.solver_iterations;
    setup.physics.top_speed_m_s = options_.aura.top_speed_m_s;
    Member& member = members_.emplace_back();
    transport::Transport* transport = &network_->endpoint(RegionId{r});
    if (options_.over_the_wire) {
      member.wire = std::make_unique<WireCheck>(*transport);
      transport = member.wire.get();
    }
    member.node = std::make_unique<node::Node>(setup, scene_, options_.map, *transport);
  }
}

ClusterSim::~ClusterSim() = default;

void ClusterSim::cut_off(const LinkCut& cut) {
  for (std::uint32_t r = 0; r < options_.map.size(); ++r) {
    if (RegionId{r} != cut.region) network_->faults().cut(cut.region, RegionId{r}, cut.from_s, cut.until_s);
  }
}

double ClusterSim::chance() {
  random_ = random_ * 6364136223846793005ull + 1442695040888963407ull;
  return static_cast<double>(random_ >> 11) * 0x1p-53;
}

Outcome ClusterSim::run(Step steps) {
  outcome_ = {};
  outcome_.hash.assign(static_cast<std::size_t>(steps) + 1, 0);
  std::uint64_t request = 0;
  for (const auto& [step, action] : options_.orders) members_[0].node->order(action, ++request, step);
  for (Member& member : members_) {
    member.node->start();
    take_reports(member);
    if (on_state) on_state(*member.node, member.node->report(), 0);
  }
  const double slice = options_.aura.step_s / 8;
  const auto behind = [&] {
    return std::any_of(members_.begin(), members_.end(),
                       [&](const Member& m) { return m.alive && !has_done(*m.node, steps); });
  };
  double t = 0;
  for (; behind(); t += slice) {
    if (t > 60 * static_cast<double>(steps) * options_.aura.step_s + 60)
      throw std::runtime_error("the cluster stands still");
    network_->advance_to(t);
    for (Member& member : members_) step_if_due(member, steps);
  }
  for (const double end = t + static_cast<double>(2 * options_.overrun) * options_.aura.step_s; t < end; t += slice) {
    network_->advance_to(t);
    for (Member& member : members_) {
      if (member.node->region() != RegionId{0}) step_if_due(member, steps + options_.overrun);
    }
  }
  settle();
  for (Member& member : members_) {
    for (const node::StepReport& report : member.node->finish(steps)) take_report(member, report);
  }
  account(outcome_);
  return outcome_;
}

bool ClusterSim::has_done(const node::Node& node, Step steps) const {
  return node.current_step() >= steps && (!options_.aura.redo || node.confirmed_step() >= steps);
}

void ClusterSim::take_reports(Member& member) {
  for (const node::StepReport& report : member.node->confirmed()) take_report(member, report);
}

void ClusterSim::step_if_due(Member& member, Step last) {
  const double now = network_->now_s();
  if (!member.alive || now < member.busy_until_s || has_done(*member.node, last)) return;
  const Step next = member.node->current_step() + 1;
  if (is_held_for_dead(member.node->region())) return end(member);
  if (now < static_cast<double>(next) * options_.aura.step_s || !member.node->ready()) return;
  const double frame = options_.frame_s + options_.frame_jitter_s * chance();
  network_->set_send_delay(frame);
  member.busy_until_s = now + frame;
  const node::StepReport& report = member.node->step();
  if (report.put_back_from && member.node->region() == RegionId{0}) {
    ++outcome_.redos;
    outcome_.again += static_cast<std::uint64_t>(*report.put_back_from - report.step);
  }
  take_reports(member);
  if (on_state) on_state(*member.node, member.node->report(), now);
  member.node->protocol().report_frame(next, frame);
  if (!options_.aura.redo) check_single_host();  // else some may have gone back already
  maybe_crash(member);
}

void ClusterSim::take_report(Member& member, const node::StepReport& report) {
  for (const node::SeenCollision& seen : report.collisions) {
    if (!seen.missed) outcome_.contacts.push_back(seen.collision);
    if (seen.late || seen.missed) outcome_.wrong.push_back({member.node->region(), seen});
  }
  for (const node::HashPart& part : report.hash) {
    if (part.step < static_cast<Step>(outcome_.hash.size()))
      outcome_.hash[static_cast<std::size_t>(part.step)] += part.sum;
  }
  for (const core::BodyEffect& effect : report.effects.bodies) {
    outcome_.effects.push_back(records::as_heard_again(effect));
  }
  for (const core::StaticEffect& effect : report.effects.statics) {
    outcome_.effects.push_back(records::as_heard_again(effect));
  }
  for (const core::JointEffect& effect : report.effects.joints) {
    outcome_.effects.push_back(records::as_heard_again(effect));
  }
  for (const physics::Removal& removal : report.removals) {
    removed_.insert(removal.body);
    if (!removal.fault.empty()) outcome_.broken.push_back(removal);
  }
  outcome_.applied += report.applied.size();
  outcome_.largest_cluster = std::max(outcome_.largest_cluster, report.largest_cluster);
  moves.insert(moves.end(), report.departures.begin(), report.departures.end());
  outcome_.hand_offs += report.departures.size();
  for (const node::HandOffRow& row : report.departures) {
    const auto [before, first] = last_departure_.try_emplace(row.body, row);
    if (first) continue;
    outcome_.thrashed += records::is_thrashing(before->second, row);
    before->second = row;
  }
}

/// On every step each body has at most one host.
void ClusterSim::check_single_host() {
  std::set<BodyId> hosted;
  for (Member& member : members_) {
    if (!member.alive) continue;
    for (const core::BodyState& body : member.node->world().snapshot().bodies) {
      seen_.insert(body.id);
      if (!hosted.insert(body.id).second) doubled_.insert(body.id);
    }
  }
}

bool ClusterSim::is_held_for_dead(RegionId region) const {
  return std::ranges::any_of(members_, [region](const Member& other) {
    const std::vector<RegionId> dead = other.node->protocol().intake().dead_regions();
    return std::ranges::find(dead, region) != dead.end();
  });
}

void ClusterSim::maybe_crash(Member& member) {
  if (!options_.crash || member.node->region() != options_.crash->region || !member.alive) return;
  if (member.node->current_step() < options_.crash->step) return;
  network_->crash(member.node->region(), options_.crash->lease_s);
  end(member);
}

void ClusterSim::end(Member& member) {
  member.alive = false;
  outcome_.dead.push_back(member.node->region());
  for (const core::BodyState& body : member.node->world().snapshot().bodies) with_dead_.insert(body.id);
  for (const core::HandOff& open : member.node->protocol().departures().open()) {
    for (const core::BodyRecord& body : open.cluster.bodies) with_dead_.insert(body.id);
  }
}

/// Every message that is under way arrives; nothing new is published.
void ClusterSim::settle() {
  outcome_.slowest_s = network_->now_s();
  if (options_.aura.redo) return;
  network_->advance_to(network_->now_s() + 1e6);
  for (Member& member : members_) {
    if (!member.alive) continue;
    member.node->ready_to_settle();
    take_report(member, member.node->settle());
  }
  check_single_host();
}

void ClusterSim::account(Outcome& outcome) {
  std::set<BodyId> found;
  for (Member& member : members_) {
    if (!member.alive) continue;
    for (const core::BodyState& body : member.node->world().snapshot().bodies) found.insert(body.id);
    for (const core::HandOff& open : member.node->protocol().departures().open()) {
      for (const core::BodyRecord& body : open.cluster.bodies) found.insert(body.id);
    }
    const core::Protocol& protocol = member.node->protocol();
    outcome.late += member.node->collision_watch().late();
    outcome.missed += member.node->collision_watch().missed();
    outcome.unflagged += member.node->collision_watch().unflagged();
    outcome.violations += protocol.violations().total();
    outcome.late_words += protocol.violations().count(core::ViolationKind::kLatency);
    outcome.severed += member.node->world().severed_contacts();
    outcome.bad_phases += protocol.projection().counters().bad_phase_changes;
  }
  outcome.doubled = doubled_.size();
  outcome.removed = removed_.size();
  for (const BodyId id : seen_) {
    if (found.contains(id) || removed_.contains(id)) continue;
    ++(with_dead_.contains(id) ? outcome.with_dead : outcome.lost);
  }
}

Outcome run_central(const core::Scene& scene, ClusterOptions options, Step steps) {
  options.map = core::RegionMap::columns(1, 1);
  options.crash.reset();
  return ClusterSim(scene, options).run(steps);
}

}  // namespace aurasim::test
