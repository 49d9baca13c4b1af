#include "process/order_issuer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "steering/command_limits.h"

namespace aurasim::process {
namespace {

struct Same {
  bool operator()(const core::Sphere& a, const core::Sphere& b) const { return a.radius == b.radius; }
  bool operator()(const core::Box& a, const core::Box& b) const { return a.half_extents == b.half_extents; }
  bool operator()(const core::Capsule& a, const core::Capsule& b) const {
    return a.radius == b.radius && a.height == b.height;
  }
  bool operator()(const core::Cylinder& a, const core::Cylinder& b) const {
    return a.radius == b.radius && a.height == b.height;
  }
  bool operator()(const core::MeshRef& a, const core::MeshRef& b) const { return a == b; }
  template <class A, class B>
  bool operator()(const A&, const B&) const {
    return false;
  }
};

const core::ClientShape* shape_in(const core::Ask& ask) {
  if (const auto* body = std::get_if<core::NewBody>(&ask)) return body->shape ? &*body->shape : nullptr;
  const auto* const fixed = std::get_if<core::NewStatic>(&ask);
  return fixed != nullptr ? &fixed->shape : nullptr;
}

/// The pose as orders contain it, with the quaternion normalized to the last bits.
core::Pose sound(const core::Pose& pose) { return {pose.p_WB, pose.q_WB.normalized()}; }

Issued refusal(std::string why) { return {std::move(why), {}, {}}; }

}  // namespace

void OrderIssuer::begin_generation() {
  closed_ = false;
  own_shapes_.clear();
  own_kinds_.clear();
  shapes_ = prototypes_ = statics_ = bodies_ = 0;
  noted_shapes_ = noted_kinds_ = 0;
}

void OrderIssuer::note(const core::Order& order) {
  if (const auto* body = std::get_if<core::Spawn>(&order.action)) {
    const std::uint64_t number = core::value_of(body->id);
    if (number >= core::kFirstClientBody) bodies_ = std::max(bodies_, number - core::kFirstClientBody);
  }
  if (const auto* defined = std::get_if<core::DefineShape>(&order.action)) {
    const std::size_t index = launch_.scene.shapes.size() + noted_shapes_++;
    const auto is_it = [index](const OwnShape& known) { return known.index == index; };
    if (std::ranges::any_of(own_shapes_, is_it)) return;
    own_shapes_.push_back({defined->shape, static_cast<std::uint32_t>(index)});
  }
  if (const auto* kind = std::get_if<core::DefinePrototype>(&order.action)) {
    const core::PrototypeId id{static_cast<std::uint32_t>(launch_.scene.prototypes.size() + noted_kinds_++)};
    const auto is_it = [id](const OwnKind& known) { return known.id == id; };
    if (std::ranges::none_of(own_kinds_, is_it)) own_kinds_.push_back({kind->shape, kind->mass_kg, id});
  }
}

Issued OrderIssuer::issue(const core::Command& command, const RunFacts& run, const node::MeshSource& meshes,
                          node::Node& node) {
  shapes_ = std::max(shapes_, node.scene().shapes.size());
  prototypes_ = std::max(prototypes_, node.scene().prototypes.size());
  statics_ = std::max(statics_, node.scene().statics.size());
  const bool changes_the_run = core::changes_the_run(command.ask);
  if (closed_) return refusal("the run is being changed: send the command again in a moment");
  if (changes_the_run && !run.complete)
    return refusal("a node has died: send the command again once its region has a node");
  const core::ClientShape* const own_shape = shape_in(command.ask);
  const steering::CommandContext context{
      launch_, node.scene(), node.current_step(), run.bodies,
      own_shape != nullptr ? shape_of(*own_shape, meshes, node.scene()) : std::nullopt};
  if (std::string why = steering::problem_with(command, context); !why.empty()) return refusal(std::move(why));
  if (const auto* body = std::get_if<core::NewBody>(&command.ask)) return spawn(command, *body, node);
  if (const auto* fixed = std::get_if<core::NewStatic>(&command.ask)) return place(command, *fixed, node);
  if (const auto* sent = std::get_if<core::SendStatic>(&command.ask)) return move(command, *sent, node);
  const std::optional<core::Action> action = std::visit(
      [](const auto& ask) -> std::optional<core::Action> {
        if constexpr (std::is_constructible_v<core::Action, decltype(ask)>) return ask;
        return {};
      },
      command.ask);
  if (!action) return refusal("this is no order");
  closed_ = changes_the_run;
  return {{}, node.order(*action, command.request, command.at_step), {}};
}

Issued OrderIssuer::spawn(const core::Command& command, const core::NewBody& body, node::Node& node) {
  const core::PrototypeId prototype = prototype_id(body, command.request, node);
  const core::BodyId id{core::kFirstClientBody + ++bodies_};
  const core::Spawn spawn{id, prototype, sound(body.pose), body.v_WB, body.w_WB};
  return {{}, node.order(spawn, command.request, command.at_step), core::ref_of(id)};
}

Issued OrderIssuer::place(const core::Command& command, const core::NewStatic& fixed, node::Node& node) {
  const std::uint32_t shape = shape_index(fixed.shape, command.request, node);
  const core::StaticId id{static_cast<std::uint32_t>(statics_++)};
  return {{},
          node.order(core::AddStatic{id, shape, sound(fixed.pose)}, command.request, command.at_step),
          core::ref_of(id)};
}

Issued OrderIssuer::move(const core::Command& command, const core::SendStatic& sent, node::Node& node) {
  const auto states = std::max<core::Step>(1, std::llround(sent.duration_s / launch_.step_s()));
  const core::MoveStatic move{sent.id, {}, sound(sent.to), states};
  return {{}, node.order(move, command.request, command.at_step), core::ref_of(sent.id)};
}

std::uint32_t OrderIssuer::shape_index(const core::ClientShape& shape, std::uint64_t request, node::Node& node) {
  for (const OwnShape& known : own_shapes_) {
    if (std::visit(Same{}, known.shape, shape)) return known.index;
  }
  node.order(core::DefineShape{shape}, request);
  own_shapes_.push_back({shape, static_cast<std::uint32_t>(shapes_++)});
  return own_shapes_.back().index;
}

core::PrototypeId OrderIssuer::prototype_id(const core::NewBody& body, std::uint64_t request, node::Node& node) {
  if (!body.shape) {
    const auto& known = node.scene().prototypes;
    const auto found = std::ranges::find(known, body.prototype, &core::Prototype::name);
    return core::PrototypeId{static_cast<std::uint32_t>(found - known.begin())};
  }
  const std::uint32_t shape = shape_index(*body.shape, request, node);
  for (const OwnKind& kind : own_kinds_) {
    if (kind.shape == shape && kind.mass_kg == body.mass_kg) return kind.id;
  }
  node.order(core::DefinePrototype{shape, body.mass_kg}, request);
  own_kinds_.push_back({shape, body.mass_kg, core::PrototypeId{static_cast<std::uint32_t>(prototypes_++)}});
  return own_kinds_.back().id;
}

std::optional<core::Shape> OrderIssuer::shape_of(const core::ClientShape& shape, const node::MeshSource& meshes,
                                                 const core::Scene& scene) const {
  for (const OwnShape& known : own_shapes_) {  // the shape is known even if its mesh has been dropped
    if (std::visit(Same{}, known.shape, shape) && known.index < scene.shapes.size()) {
      return scene.shapes[known.index].shape;
    }
  }
  return std::visit(
      [&](const auto& s) -> std::optional<core::Shape> {
        if constexpr (std::is_constructible_v<core::Shape, decltype(s)>) {
          return s;
        } else {
          return meshes(s);
        }
      },
      shape);
}

}  // namespace aurasim::process
