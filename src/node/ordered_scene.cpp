#include "node/ordered_scene.h"

#include <algorithm>
#include <variant>

#include "core/static_moves.h"
#include "node/scene_additions.h"
#include "physics/region_world.h"

namespace aurasim::node {
namespace {

/// True if a saved world has to contain the order. Orders that change the run as a whole are left out.
bool is_kept(const core::Action& action) {
  return !core::changes_the_run(action) && !std::holds_alternative<core::Redo>(action) &&
         !std::holds_alternative<core::Save>(action);
}

}  // namespace

void OrderedScene::execute(const core::Order& order, core::Step now) {
  keep(order, now);
  extend(scene_, order.action, meshes_);
  if (changes_scene(order.action)) newest_change_ = order.sequence;
}

void OrderedScene::keep(const core::Order& order, core::Step now) {
  if (!is_kept(order.action)) return;
  orders_.push_back(order);
  if (orders_.size() <= 2 * most_kept_) return;
  const std::uint64_t newest = newest_spawn() ? newest_spawn()->sequence : 0;
  std::erase_if(orders_, [&](const core::Order& old) {
    return !changes_scene(old.action) && old.at_step < now - physics::kOrderMemory && old.sequence != newest;
  });
  core::forget_moves_before(now - physics::kOrderMemory, orders_);
  most_kept_ = std::max<std::size_t>(most_kept_, orders_.size());
}

/// The newest order of a request counts: a request that first defines a shape for its body counts as the order of the
/// body.
const core::Order* OrderedScene::of_request(std::uint64_t request) const {
  const auto found = std::ranges::find(orders_.rbegin(), orders_.rend(), request, &core::Order::request);
  return request == 0 || found == orders_.rend() ? nullptr : &*found;
}

/// The newest order that makes a body. The number of the next body follows from it.
const core::Order* OrderedScene::newest_spawn() const {
  const auto spawns = [](const core::Order& order) { return std::holds_alternative<core::Spawn>(order.action); };
  const auto newest = std::ranges::find_if(orders_.rbegin(), orders_.rend(), spawns);
  return newest == orders_.rend() ? nullptr : &*newest;
}

/// The shape of a mesh is known once its order has been executed.
void OrderedScene::add_to(core::WorldCut& part, core::Step after, std::span<const core::Order> to_come) const {
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
  for (const core::Order& order : to_come) {
    if (is_kept(order.action)) part.orders.push_back(order);
  }
  core::forget_moves_before(after + 1, part.orders);
}

}  // namespace aurasim::node
