#include "lab/trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/usual_uncertainty.h"

namespace aurasim::lab {
namespace {

const node::SeenCollision* first_contact(const node::StepReport& report) {
  const auto touches = [](const node::SeenCollision& seen) { return !seen.missed; };
  const auto found = std::find_if(report.collisions.begin(), report.collisions.end(), touches);
  return found != report.collisions.end() ? &*found : nullptr;
}

}  // namespace

ClusterRules rules_of(const Conditions& conditions, const Variant& variant, const Disorder& disorder) {
  ClusterRules rules;
  rules.aura = rules_for(variant.aura, conditions);
  rules.aura.uncertainty = core::usual_uncertainty(variant.sync, rules.aura.lookahead);
  rules.sync = variant.sync;
  rules.network.latency_s = conditions.latency_s;
  rules.network.loss = conditions.loss;
  rules.network.resend_after_s = resend_after_s(conditions);
  rules.longest_frame_s = conditions.frame_s;
  rules.shortest_frame_s = 0.9 * conditions.frame_s;
  rules.phase_s = disorder.phase_s;
  rules.seed = disorder.seed;
  return rules;
}

core::Step last_step(const Pair& pair, const Conditions& conditions, const std::optional<Contact>& central) {
  const core::Step passed = central ? central->step - pair.expected_step + pair.passed_step : pair.passed_step;
  return passed + 6 * lookahead(conditions.promised) + 6;
}

Contact contact_of(const node::SeenCollision& seen) {
  return {seen.collision.step, seen.collision.penetration_m, seen.collision.relative_speed_m_s};
}

void count_hand_offs(Trial& trial, HandOffs hand_offs, core::Step met) {
  std::erase_if(hand_offs, [&](const auto& h) { return std::get<0>(h) >= met; });
  trial.hand_offs = hand_offs.size();
  trial.pulls = static_cast<std::uint64_t>(std::count_if(hand_offs.begin(), hand_offs.end(), [](const auto& h) {
    return std::get<core::HandOffReason>(h) == core::HandOffReason::kAuraCollision;
  }));
}

Disorder make_disorder(const Conditions& conditions, Chance& chance) {
  Disorder disorder;
  for (int r = 0; r < 4; ++r) disorder.phase_s.push_back(chance.between(0, conditions.frame_s));
  disorder.seed = 1 + chance.below(1u << 31);
  return disorder;
}

double resend_after_s(const Conditions& conditions) { return kHeartbeat_s + 2 * conditions.latency_s; }

std::optional<Contact> run_central(const Pair& pair, const Conditions& conditions) {
  ClusterRules rules;
  rules.aura = rules_for(AuraChoice::kTight, conditions);
  VirtualCluster cluster(pair.scene, core::RegionMap::columns(1, 1), rules);
  const core::Step last = last_step(pair, conditions, std::nullopt);
  while (cluster.slowest() < last) {
    const VirtualCluster::Event event = cluster.next();
    if (const node::SeenCollision* seen = first_contact(*event.report)) return contact_of(*seen);
  }
  return std::nullopt;
}

Trial run_pair(const Pair& pair, const Conditions& conditions, const Variant& variant, const Disorder& disorder,
               const std::optional<Contact>& central) {
  Trial trial;
  trial.variant = variant;
  if (central) trial.central_step = central->step;
  VirtualCluster cluster(pair.scene, pair.map, rules_of(conditions, variant, disorder));
  const core::Step last = last_step(pair, conditions, central);
  HandOffs hand_offs;
  while (!trial.contact && cluster.slowest() < last) {
    // Late messages of a step are known before it is computed, so they count. Other violations in it may come from the
    // contact itself.
    trial.violations = cluster.violations() - cluster.violations(core::ViolationKind::kLatency);
    const VirtualCluster::Event event = cluster.next();
    trial.violations += cluster.violations(core::ViolationKind::kLatency);
    for (const node::HandOffRow& row : event.report->departures) {
      hand_offs.emplace(row.stamp, row.source, row.destination, row.reason);
    }
    if (const node::SeenCollision* seen = first_contact(*event.report)) {
      trial.contact = contact_of(*seen);
      trial.flagged = seen->flagged;
    }
  }
  const core::Step met = trial.contact ? trial.contact->step : trial.central_step.value_or(last);
  count_hand_offs(trial, std::move(hand_offs), met);
  trial.same_bits = trial.contact == central;
  trial.slow_down = cluster.slow_down();
  return trial;
}

}  // namespace aurasim::lab
