// How statics follow the setpoints of programs (docs/decisions/0030-a-word-before-its-order.md). The node that takes
// orders makes an order of each setpoint that it receives. The other nodes go by the setpoints that they receive
// themselves until the order comes, if a client's step waits for these setpoints on all nodes, or if the nodes compute
// again what the order makes different.
#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

#include "node/node.h"

namespace aurasim::node {

bool Node::can_go(std::span<const core::StaticSetpoint> statics) const {
  if (!statics.empty() && !setup_.physics.looks_once()) return false;
  return std::ranges::all_of(statics, [this](const core::StaticSetpoint& wanted) {
    const std::uint32_t index = core::value_of(wanted.id);
    if (index >= scene().statics.size() || !core::is_sound(wanted)) return false;
    return !std::holds_alternative<core::Plane>(scene().shapes[scene().statics[index].shape].shape);
  });
}

/// True if this node is the lead: the live node of the lowest region.
bool Node::leads() const {
  const auto dead = protocol_->intake().dead_regions();
  return std::ranges::count_if(dead, [this](core::RegionId other) { return other < region(); }) ==
         static_cast<std::ptrdiff_t>(core::value_of(region()));
}

/// True if all nodes go by the setpoints that they receive. A node that is alone always does, because no other node can
/// differ.
bool Node::believes_programs() const {
  if (protocol_->round() == 0) return true;
  return protocol_->computes_again() && statics_.are_believed(current_step());
}

core::Heard Node::hear_of_statics(const core::Setpoints& setpoints, core::Heard heard, bool known_to_all) {
  const bool is_dropped = heard == core::Heard::kLate && setup_.control.late == core::LateSetpoint::kDropped;
  if (is_dropped) return heard;
  const bool at_once = setpoints.at_step != 0 && (known_to_all || believes_programs());
  for (const core::StaticSetpoint& wanted : setpoints.statics) {
    const std::uint64_t request = request_of(setpoints, wanted.id);
    if (leads()) {
      heard = std::max(heard, order_move(wanted, setpoints.at_step, request, at_once));
    } else if (at_once && heard == core::Heard::kInTime) {
      // The lead refuses what is too much in one state. Where nothing is computed again, this node must not expect it.
      if (!protocol_->computes_again() && !statics_.may_order(current_step())) return core::Heard::kRefused;
      expect(wanted, setpoints.at_step, request);
    }
  }
  return heard;
}

void Node::expect(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request) {
  const core::PlannedMove plan =
      core::planned(wanted, at_step, world_.moves(), scene().statics[core::value_of(wanted.id)], setup_.physics.step_s);
  world_.moves().expect(plan.move, plan.at_step, request);
}

const core::Order& Node::give_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request) {
  core::Order order;
  order.request = request;
  order.at_step = at_step;
  order.action = core::MoveStatic{wanted.id, {}, wanted.to, wanted.states};
  return give(std::move(order));
}

/// Makes an order of a static's setpoint. Unless all nodes go by the setpoint itself (`at_once`), the move waits until
/// all nodes can have the order.
core::Heard Node::order_move(const core::StaticSetpoint& wanted, core::Step at_step, std::uint64_t request,
                             bool at_once) {
  const auto is_it = [request](const core::Order& order) { return order.request == request; };
  if (ordered(request) != nullptr || std::ranges::any_of(protocol_->orders_to_come(), is_it))
    return core::Heard::kInTime;
  if (is_changing_ || !statics_.may_order(current_step())) return core::Heard::kRefused;
  // Where regions are coupled, nobody foresees what a static will meet.
  const core::Step agreed = owners_ ? protocol_->earliest_agreement() : protocol_->earliest_effect();
  const core::Step earliest = at_once ? current_step() + 1 : agreed;
  const bool is_late = at_step != 0 && at_step < earliest;
  if (is_late && setup_.control.late == core::LateSetpoint::kDropped) return core::Heard::kLate;
  const core::Order& given = give_move(wanted, std::max(at_step, earliest), request);
  return at_step != 0 && given.at_step > at_step ? core::Heard::kLate : core::Heard::kInTime;
}

/// Expects the moves of the record, which all nodes know from the beginning. Their orders are given for observers.
void Node::expect_recorded_moves() {
  for (const core::StaticEffect& recorded : statics_.recorded()) {
    if (!can_go({&recorded.setpoint, 1}))
      throw std::invalid_argument("the record moves a static that cannot move here");
    expect(recorded.setpoint, recorded.step, request_of(recorded));
  }
}

void Node::order_recorded_moves() {
  const core::Step until = protocol_->earliest_effect() + 1;
  while (const core::StaticEffect* const recorded = statics_.next_recorded(until)) {
    if (leads() && is_changing_) return;
    statics_.pass();
    if (!leads() || recorded->step <= current_step() || ordered(request_of(*recorded)) != nullptr) continue;
    give_move(recorded->setpoint, recorded->step, request_of(*recorded));
  }
}

/// Gives up expected moves whose orders should have come by now.
void Node::give_up_expected() {
  if (!protocol_->computes_again()) return;
  const core::Step next = current_step() + 1;
  const auto changed = world_.moves().give_up_expected(next - protocol_->round());
  if (changed && *changed <= current_step()) doubt(*changed);
}

/// Doubts state `step`: it was computed with a static in another place than the order puts it. Where it cannot be
/// computed again, that is a violation.
void Node::doubt(core::Step step) {
  if (protocol_->computes_again()) return protocol_->doubt(step);
  protocol_->report_late_word(step, current_step() + 1 - step);
}

/// Reports the moves of statics that begin after this state, for the record. Only the lead does so.
void Node::note_moves() {
  if (!leads()) return;
  world_.moves().for_each_from(current_step(), [this](const core::MoveStatic& move) {
    report_.effects.statics.push_back({current_step(), {move.id, move.to, move.states}});
  });
}

}  // namespace aurasim::node
