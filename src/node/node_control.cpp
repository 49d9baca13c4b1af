// How a node receives setpoints of programs (core/control_log.h) and reports their effects.
#include <algorithm>

#include "core/horizon.h"
#include "node/node.h"

namespace aurasim::node {
namespace {

/// Number of states for which setpoints are kept. When a node has died, a run goes back no farther, unless checkpoints
/// are farther apart.
constexpr core::Step kRemembered = 600;

}  // namespace

core::Heard Node::hear(const core::Setpoints& setpoints, bool known_to_all) {
  if (!can_go(setpoints.statics)) return core::Heard::kRefused;
  const core::Step notice = setup_.protocol.aura.lookahead + 1;
  const core::Heard heard = world_.controls().hear(setpoints, current_step(), notice, scene().joints.size());
  const bool is_late = heard == core::Heard::kLate && !(setpoints.bodies.empty() && setpoints.joints.empty());
  if (is_late) late_words_.note(setpoints.at_step, current_step());
  return heard == core::Heard::kRefused ? heard : hear_of_statics(setpoints, heard, known_to_all);
}

/// To be called when the reported states from `from` to `until` are computed again, perhaps on other hosts. Setpoints
/// for one of these states may have been received there at another time. That host then computes another world, and no
/// alarm shows it, so such setpoints are reported as violations.
void Node::note_late_words(core::Step from, core::Step until) {
  for (const LateWords::Word& word : late_words_.that_matter(from, until)) {
    protocol_->report_late_word(word.at_step, word.heard + 1 - word.at_step);
  }
}

/// True if the body is hosted here, and was in the state before, too.
bool Node::stays(core::BodyId id) const {
  return world_.contains(id) && std::ranges::find(report_.arrivals, id, &HandOffRow::body) == report_.arrivals.end();
}

/// Reports the setpoints that are new in the state that has just been computed.
void Node::note_effects() {
  if (world_.controls().empty()) return;
  const bool all_stay = report_.removals.empty() && report_.arrivals.empty();
  report_.effects.bodies.reserve(world_.new_setpoints().size());
  for (const core::BodySetpoint& setpoint : world_.new_setpoints()) {
    if (all_stay || stays(setpoint.id)) report_.effects.bodies.push_back({current_step(), setpoint});
  }
  note_effects_on_arrivals();
}

/// Reports the setpoints that are new in the present state, after the run has gone back to it.
void Node::note_effects_anew() {
  const core::ControlLog& controls = world_.controls();
  if (controls.empty()) return;
  const core::Step n = current_step();
  const auto is_wanted = [this](core::BodyId id) { return stays(id); };
  controls.for_each_body(n, is_wanted, [&](core::BodyId id, core::Quantity quantity, const auto& value, bool is_new) {
    if (is_new) report_.effects.bodies.push_back({n, {id, quantity, value}});
  });
  note_effects_on_arrivals();
}

/// Reports, for bodies that have arrived and for their joints, all that has been in effect since they left their former
/// host. That host has reported the earlier states.
void Node::note_effects_on_arrivals() {
  const core::ControlLog& controls = world_.controls();
  const core::Step n = current_step();
  const auto arrival = [&](core::BodyId id) { return std::ranges::find(report_.arrivals, id, &HandOffRow::body); };
  const auto is_here = [this](core::BodyId id) { return world_.contains(id); };
  core::Step oldest = n;
  for (const HandOffRow& row : report_.arrivals) {
    const core::Step first = row.stamp + 1;
    oldest = std::min(oldest, first);
    for (core::Step step = first; is_here(row.body) && step <= n; ++step) {
      controls.for_each_of(row.body, step, [&](core::Quantity quantity, const auto& value, bool is_new) {
        if (is_new || step == first) report_.effects.bodies.push_back({step, {row.body, quantity, value}});
      });
    }
  }
  for (core::Step step = oldest; step <= n; ++step) {
    controls.for_each_joint(step, [&](core::JointId id, const auto& drive, bool is_new) {
      const core::BodyId body = scene().joints[core::value_of(id)].a;
      const auto row = arrival(body);
      const bool has_come = row != report_.arrivals.end();
      const bool is_told = has_come ? step == row->stamp + 1 || (step > row->stamp && is_new) : step == n && is_new;
      if (is_told && is_here(body)) report_.effects.joints.push_back({step, {id, drive}});
    });
  }
}

/// Reports that the setpoints of leaving bodies end after state `last`, because their next host may have received fewer
/// of them. Drives of joints go with the body.
void Node::note_left_behind(std::span<const core::BodyRecord> bodies, core::Step last) {
  const core::ControlLog& controls = world_.controls();
  for (const core::BodyRecord& body : bodies) {
    controls.for_each_of(body.id, last, [&](core::Quantity quantity, const auto& value, bool) {
      if (value) report_.effects.bodies.push_back({last + 1, {body.id, quantity, {}}});
    });
  }
}

void Node::forget_setpoints() {
  const core::Step n = current_step();
  const core::Step oldest_cut = cuts_.empty() ? n : cuts_.oldest();
  world_.controls().forget_before(std::min(oldest_cut, n - kRemembered));
}

}  // namespace aurasim::node
