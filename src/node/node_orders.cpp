// Orders made from clients' requests. The node that takes orders gives each a number and a state; all nodes execute it.
#include <algorithm>
#include <optional>
#include <utility>

#include "node/node.h"
#include "node/scene_additions.h"

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
                                               scene_.statics.at(core::value_of(move.id)), setup_.physics.step_s);
  order.at_step = plan.at_step;
  move = plan.move;
}

/// Applies the part of an order that takes effect at once. The rest waits for the state that the order names.
void Node::heed(const core::Order& order) {
  report_.orders.push_back(order);
  remember(order);
  extend(scene_, order.action, meshes_);
  if (changes_scene(order.action)) newest_scene_order_ = order.sequence;
  if (std::holds_alternative<core::Redo>(order.action)) {
    redo_ = order;
  } else if (std::holds_alternative<core::Save>(order.action)) {
    save(order.at_step);
  } else if (std::holds_alternative<core::Spawn>(order.action)) {
    to_spawn_.push_back(order);
    for (Cut& cut : cuts_) cut.to_spawn.push_back(order);
    for (Saving& saving : saving_) {
      if (saving.cut) saving.cut->to_spawn.push_back(order);
    }
  } else {
    const std::optional<core::Step> changed = world_.schedule(order);
    if (changed && *changed <= current_step()) doubt(*changed);
  }
}

/// Announces bodies that orders make. They are announced as births from injectors are, but in the state that the order
/// names.
void Node::announce_spawns(core::Step birth) {
  std::erase_if(to_spawn_, [&](const core::Order& order) {
    if (order.at_step > birth) return false;
    const auto& spawn = std::get<core::Spawn>(order.action);
    if (map_->owner(spawn.pose.p_WB) != region() || world_.contains(spawn.id)) return true;
    core::BodyRecord record = record_of(spawn, order.at_step);
    record.epoch = first_epoch_;
    world_.schedule(order);  // the body's shape may be new
    world_.add({&record, 1});
    watch_.newborn(record.id, record.birth);
    report_.births.push_back({record.id, record.birth});
    report_.applied.push_back({order.request, order.at_step, core::ref_of(record.id)});
    return true;
  });
}

}  // namespace aurasim::node
