// The scene with all that orders have added to it, and the orders themselves. A saved world contains those that have
// changed the scene, and those that still matter.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/order.h"
#include "core/scene.h"
#include "core/world_cut.h"

namespace aurasim::node {

/// Returns the shape that a mesh reference names, or nothing if the process does not have that mesh.
using MeshSource = std::function<std::optional<core::Shape>(const core::MeshRef&)>;

class OrderedScene {
 public:
  explicit OrderedScene(const core::Scene& scene) : scene_(scene), first_own_shape_(scene.shapes.size()) {}

  /// Sets where the shapes of clients' meshes come from, and returns what was set before.
  MeshSource use_meshes(MeshSource source) { return std::exchange(meshes_, std::move(source)); }
  const MeshSource& meshes() const { return meshes_; }

  /// Keeps an order, and adds to the scene what it defines. `now`: the present state.
  void execute(const core::Order& order, core::Step now);

  const core::Scene& scene() const { return scene_; }
  /// The order that a client's request has become; null if it is not known, or not kept any more.
  const core::Order* of_request(std::uint64_t request) const;
  /// Sequence of the newest order that has changed the scene; 0: none.
  std::uint64_t newest_change() const { return newest_change_; }

  /// Adds to `part` the orders that have changed the scene, and those for states after `after`. `to_come`: orders that
  /// have been received and not executed yet.
  void add_to(core::WorldCut& part, core::Step after, std::span<const core::Order> to_come) const;

 private:
  void keep(const core::Order& order, core::Step now);
  const core::Order* newest_spawn() const;

  core::Scene scene_;
  MeshSource meshes_;
  std::vector<core::Order> orders_;  ///< in sequence
  std::uint64_t newest_change_ = 0;
  std::size_t most_kept_ = 1024;  ///< upper bound of those in orders_ that may not be forgotten
  std::size_t first_own_shape_;   ///< index of the first shape that an order added to the scene's file
};

}  // namespace aurasim::node
