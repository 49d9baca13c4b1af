// How a node hands out its part of the world in a state (docs/design.md, "The cut").
#include <algorithm>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/scene_additions.h"
#include "node/timed.h"

namespace aurasim::node {
namespace {

/// True if a saved world has to contain the order. Orders that change the run as a whole are left out.
bool is_kept(const core::Action& action) {
  return !core::changes_the_run(action) && !std::holds_alternative<core::Redo>(action) &&
         !std::holds_alternative<core::Save>(action);
}

}  // namespace

void Node::save(core::Step step) {
  if (step > current_step()) saving_.push_back({step, {}, false, false});
}

/// Notes which saved states are whole. To be called before the clusters for the next state are taken in, because some
/// of them left before a saved state.
void Node::note_arrived() {
  for (Saving& saving : saving_) {
    saving.is_whole =
        saving.cut && current_step() + 1 >= saving.step + setup_.protocol.aura.lookahead && has_all_until(saving.step);
  }
}

void Node::save_if_due() {
  const Timed timed(report_.durations.cut_s, setup_.clock);
  for (Saving& saving : saving_) {
    if (saving.step == current_step()) saving.cut = cut();
  }
}

/// Makes a part of a saved world. It contains the orders known when the part is complete, and all that they have made.
core::WorldCut Node::part_of_world(Cut cut) const {
  core::WorldCut part;
  part.step = cut.step;
  part.births_known = cut.step + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  part.bodies = std::move(cut.bodies);
  core::Step oldest = cut.step;
  for (core::Adoption& adoption : cut.joining) {
    oldest = std::min(oldest, adoption.stamp);
    part.under_way.push_back({adoption.stamp, std::move(adoption.cluster)});
  }
  add_orders(part, oldest);
  return part;
}

core::WorldCut Node::orders_now(const core::WorldCut& earlier) const {
  core::WorldCut part;
  part.step = earlier.step;
  part.births_known = earlier.births_known;
  core::Step oldest = earlier.step;
  for (const core::UnderWay& one : earlier.under_way) oldest = std::min(oldest, one.stamp);
  add_orders(part, oldest);
  return part;
}

/// Adds the orders that have changed the scene, and those for states later than `after`. The shape of a mesh is known
/// once its order has been executed.
void Node::add_orders(core::WorldCut& part, core::Step after) const {
  part.last_order = protocol_->last_order();
  part.setpoints = world_.controls().since(after);
  const core::Order* const newest = newest_spawn();
  std::size_t shape = first_own_shape_;
  for (const core::Order& order : orders_) {
    if (const auto* defined = std::get_if<core::DefineShape>(&order.action)) {
      const auto* const mesh = std::get_if<core::MeshRef>(&defined->shape);
      if (mesh != nullptr) part.shapes.push_back({*mesh, scene_.shapes[shape].shape});
      ++shape;
    }
    if (changes_scene(order.action) || order.at_step > after || &order == newest) part.orders.push_back(order);
  }
  for (const core::Order& order : protocol_->orders_to_come()) {
    if (is_kept(order.action)) part.orders.push_back(order);
  }
  core::forget_moves_before(after + 1, part.orders);
}

std::optional<core::WorldCut> Node::present_part() const {
  if (!has_all_until(current_step())) return std::nullopt;
  Cut now = cut();
  for (const core::HandOff& to_come : protocol_->intake().to_come()) {
    if (to_come.stamp > current_step()) continue;
    now.joining.push_back({to_come.source, to_come.stamp, to_come.sequence, to_come.reason, to_come.cluster});
  }
  return part_of_world(std::move(now));
}

std::vector<core::WorldCut> Node::take_saved() {
  std::vector<core::WorldCut> complete;
  std::erase_if(saving_, [&](Saving& saving) {
    if (saving.is_the_end || !saving.is_whole || !saving.cut || confirmed_step() < saving.step) return false;
    complete.push_back(part_of_world(std::move(*saving.cut)));
    return true;
  });
  return complete;
}

/// The newest order of a request counts: a request that first defines a shape for its body counts as the order of the
/// body.
const core::Order* Node::ordered(std::uint64_t request) const {
  const auto found = std::ranges::find(orders_.rbegin(), orders_.rend(), request, &core::Order::request);
  return request == 0 || found == orders_.rend() ? nullptr : &*found;
}

/// The newest order that makes a body. The number of the next body follows from it.
const core::Order* Node::newest_spawn() const {
  const auto spawns = [](const core::Order& order) { return std::holds_alternative<core::Spawn>(order.action); };
  const auto newest = std::ranges::find_if(orders_.rbegin(), orders_.rend(), spawns);
  return newest == orders_.rend() ? nullptr : &*newest;
}

/// Keeps an order for worlds that are saved later.
void Node::remember(const core::Order& order) {
  if (!is_kept(order.action)) return;
  orders_.push_back(order);
  if (orders_.size() <= 2 * orders_kept_) return;
  const std::uint64_t newest = newest_spawn() ? newest_spawn()->sequence : 0;
  std::erase_if(orders_, [&](const core::Order& old) {
    return !changes_scene(old.action) && old.at_step < current_step() - physics::kOrderMemory && old.sequence != newest;
  });
  core::forget_moves_before(current_step() - physics::kOrderMemory, orders_);
  orders_kept_ = std::max<std::size_t>(orders_kept_, orders_.size());
}

}  // namespace aurasim::node
