#include "node/saved_world_check.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <variant>

namespace aurasim::node {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("the saved world does not fit the scene: " + what);
}

/// Checks that everything that an order names exists when the order is executed.
class OrderCheck {
 public:
  explicit OrderCheck(const core::Scene& scene)
      : shapes_(scene.shapes.size()), prototypes_(scene.prototypes.size()), statics_(scene.statics.size()) {}

  void look(const core::Order& order) {
    if (std::holds_alternative<core::DefineShape>(order.action)) ++shapes_;
    if (const auto* kind = std::get_if<core::DefinePrototype>(&order.action)) {
      if (kind->shape >= shapes_) refuse("an order names a shape that is not there");
      ++prototypes_;
    }
    if (const auto* added = std::get_if<core::AddStatic>(&order.action)) {
      if (added->shape >= shapes_ || core::value_of(added->id) != statics_) refuse("an order adds an unknown static");
      ++statics_;
    }
    const auto* moved = std::get_if<core::MoveStatic>(&order.action);
    if (moved != nullptr && core::value_of(moved->id) >= statics_) refuse("an order moves a static that is not there");
    const auto* spawn = std::get_if<core::Spawn>(&order.action);
    if (spawn != nullptr && core::value_of(spawn->prototype) >= prototypes_) {
      refuse("an order makes a body of a kind that is not there");
    }
  }

 private:
  std::size_t shapes_, prototypes_, statics_;
};

void check(const core::ClusterState& cluster, const core::Scene& scene) {
  for (const core::BodyRecord& body : cluster.bodies) {
    if (core::value_of(body.prototype) >= scene.prototypes.size()) {
      refuse("body " + std::to_string(core::value_of(body.id)) + " is of a kind that is not there");
    }
  }
  const auto is_known = [&](core::ObjectRef ref) {
    return ref >= 0 || static_cast<std::size_t>(-1 - ref) < scene.statics.size();
  };
  for (const core::ManifoldRecord& manifold : cluster.manifolds) {
    if (!is_known(manifold.object0) || !is_known(manifold.object1)) refuse("a body touches a static that is not there");
  }
  for (const core::JointRecord& joint : cluster.joints) {
    if (core::value_of(joint.id) >= scene.joints.size()) refuse("there are more joints than the scene has");
  }
}

}  // namespace

void check_orders(const core::WorldCut& world, const core::Scene& scene) {
  for (const core::Setpoints& said : world.setpoints) {
    const auto is_unknown = [&](const core::JointSetpoint& joint) {
      return core::value_of(joint.id) >= scene.joints.size();
    };
    if (std::ranges::any_of(said.joints, is_unknown)) refuse("setpoints are of a joint that the scene has not");
  }
  OrderCheck check_order(scene);
  for (const core::Order& order : world.orders) check_order.look(order);
}

void check_bodies(const core::WorldCut& world, const core::Scene& scene) {
  check(world.bodies, scene);
  for (const core::UnderWay& one : world.under_way) {
    check(one.cluster, scene);
    if (one.stamp > world.step) refuse("a cluster left after the state that was saved");
  }
}

}  // namespace aurasim::node
