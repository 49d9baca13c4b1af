#include "node/scene_additions.h"

namespace aurasim::node {
namespace {

using Meshes = std::function<std::optional<core::Shape>(const core::MeshRef&)>;

constexpr double kStandInRadius_m = 0.1;

struct ShapeMaker {
  const Meshes& meshes;

  template <class Primitive>
  core::Shape operator()(const Primitive& shape) const {
    return shape;
  }
  core::Shape operator()(const core::MeshRef& mesh) const {
    std::optional<core::Shape> found = meshes ? meshes(mesh) : std::nullopt;
    return found ? *found : core::Shape(core::Sphere{kStandInRadius_m});
  }
};

}  // namespace

void extend(core::Scene& scene, const core::Action& action, const Meshes& meshes) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  if (const auto* shape = std::get_if<core::DefineShape>(&action)) {
    scene.shapes.push_back({"client", std::visit(ShapeMaker{meshes}, shape->shape)});
  } else if (const auto* prototype = std::get_if<core::DefinePrototype>(&action)) {
    scene.prototypes.push_back({"client", prototype->shape, 0, prototype->mass_kg, true});
  } else if (const auto* added = std::get_if<core::AddStatic>(&action)) {
    scene.statics.push_back({.name = "client", .shape = added->shape, .pose = added->pose});
  }
}

core::BodyRecord record_of(const core::Spawn& spawn, core::Step birth) {
  return core::initial_record({spawn.id, spawn.prototype, spawn.pose, spawn.v_WB, spawn.w_WB}, birth);
}

bool changes_scene(const core::Action& action) {
  return std::holds_alternative<core::DefineShape>(action) || std::holds_alternative<core::DefinePrototype>(action) ||
         std::holds_alternative<core::AddStatic>(action) || std::holds_alternative<core::RemoveStatic>(action) ||
         std::holds_alternative<core::MoveStatic>(action);
}

}  // namespace aurasim::node
