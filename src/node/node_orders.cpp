// Orders made from clients' requests. The node that takes orders gives each a number and a state; all nodes execute it.
#include <algorithm>
#include <optional>
#include <utility>

#include "node/node.h"

namespace aurasim::node {

const core::Order& Node::order(const core::Action& action, std::uint64_t request, core::Step at_step) {
  core::Order order;
  order.request = request;
  order.at_step = std::max(at_step, protocol_->earliest_effect());
  order.action = action;
  is_changing_ = is_changing_ || core::changes_the_run(action);
  return give(std::move(order));
}

const core::Order& Node::give(core::Order order) {
  if (std::holds_alternative<core::MoveStatic>(order.action)) complete(order);
  return protocol_->announce(std::move(order));
}

/// Fills in where a moved static starts: its place at that state, after all moves ordered so far.
void Node::complete(core::Order& order) const {
  auto& move = std::get<core::MoveStatic>(order.action);
  core::StaticMoves moves = world_.moves().ordered(move.id);
  for (const core::Order& other : protocol_->orders_to_come()) {
    if (const auto* known = std::get_if<core::MoveStatic>(&other.action))
      moves.add(*known, other.at_step, other.request);
  }
  const core::PlannedMove plan = core::planned({move.id, move.to, move.states}, order.at_step, moves,
                                               scene().statics.at(core::value_of(move.id)), setup_.physics.step_s);
  order.at_step = plan.at_step;
  move = plan.move;
}

/// Applies the part of an order that takes effect at once. The rest waits for the state that the order names.
void Node::execute(const core::Order& order) {
  report_.orders.push_back(order);
  scene_.execute(order, current_step());
  if (std::holds_alternative<core::Redo>(order.action)) {
    // learn_of_redos() has taken note of it
  } else if (std::holds_alternative<core::Save>(order.action)) {
    save(order.at_step);
  } else if (std::holds_alternative<core::Spawn>(order.action)) {
    to_be_born_.spawns.push_back(order);
    cuts_.note_spawn(order);
    saved_.note_spawn(order);
  } else {
    const std::optional<core::Step> changed = world_.schedule(order);
    if (changed && *changed <= current_step()) doubt(*changed);
  }
}

}  // namespace aurasim::node
