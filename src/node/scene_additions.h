// Additions that orders make to the scene. Every node makes the same additions in the same sequence, so that an index
// means the same thing on every node.
#pragma once

#include <functional>
#include <optional>

#include "core/order.h"
#include "core/scene.h"

namespace aurasim::node {

/// Adds what the action defines; other actions change nothing. A mesh that `meshes` does not have becomes a ball of
/// 10 cm, so that indices stay the same: orders are only taken once every node has the mesh.
void extend(core::Scene& scene, const core::Action& action,
            const std::function<std::optional<core::Shape>(const core::MeshRef&)>& meshes);

/// The body that an order makes. `birth`: the state in which it exists first. Its epoch is 0.
core::BodyRecord record_of(const core::Spawn& spawn, core::Step birth);

/// True if the action adds, removes or moves something that observers have to know of the scene.
bool changes_scene(const core::Action& action);

}  // namespace aurasim::node
