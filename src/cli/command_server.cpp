#include "cli/command_server.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "cli/command_limits.h"
#include "config/meshes.h"
#include "node/scene_additions.h"

namespace aurasim::cli {
namespace {

constexpr int kRoundsForMesh = 300;

struct Same {
  bool operator()(const core::Sphere& a, const core::Sphere& b) const { return a.radius == b.radius; }
  bool operator()(const core::Box& a, const core::Box& b) const { return a.half_extents == b.half_extents; }
  bool operator()(const core::Capsule& a, const core::Capsule& b) const {
    return a.radius == b.radius && a.height == b.height;
  }
  bool operator()(const core::Cylinder& a, const core::Cylinder& b) const {
    return a.radius == b.radius && a.height == b.height;
  }
  bool operator()(const core::MeshRef& a, const core::MeshRef& b) const { return a.hash == b.hash && a.use == b.use; }
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

const core::MeshRef* mesh_in(const core::Ask& ask) {
  const core::ClientShape* const shape = shape_in(ask);
  return shape != nullptr ? std::get_if<core::MeshRef>(shape) : nullptr;
}

}  // namespace

CommandServer::CommandServer(const config::Launch& launch, dds::Participant& participant, core::RegionId region)
    : launch_(launch),
      region_(region),
      endpoint_(participant, region, launch.regions.version()),
      mesh_reader_(participant),
      additions_writer_(participant, region) {}

void CommandServer::begin_generation(node::Node& node, core::Generation generation) {
  additions_ = {generation, {}};
  closed_ = false;
  reply_all_done(0);
  own_shapes_.clear();
  own_kinds_.clear();
  shapes_ = prototypes_ = statics_ = 0;
  node.use_meshes([this](const core::MeshRef& mesh) { return make_mesh(mesh); });
}

void CommandServer::change_map(core::Generation generation, core::Step step) {
  endpoint_.use_map(launch_.regions.version());
  additions_.generation = generation;
  reply_all_done(step);
  if (leads_) additions_writer_.send(additions_);
  closed_ = false;
}

void CommandServer::serve(node::Node& node, const RunView& run) {
  leads_ = run.leads;
  shapes_ = std::max(shapes_, node.scene().shapes.size());
  prototypes_ = std::max(prototypes_, node.scene().prototypes.size());
  statics_ = std::max(statics_, node.scene().statics.size());
  std::vector<Asked> asked = std::exchange(waiting_for_mesh_, {});
  for (core::Command& command : endpoint_.take()) asked.push_back({std::move(command), 0});
  for (Asked& one : asked) {
    const auto* const mesh = mesh_in(one.command.ask);
    const bool has_it =
        mesh == nullptr || has_mesh(mesh->hash);  // also where it is not asked for: the lead wants to know
    if (const auto* ray = std::get_if<core::Ray>(&one.command.ask)) {
      answer(one.command, *ray, node);
    } else if (run.leads && has_it && (mesh == nullptr || run.all_have(mesh->hash))) {
      decide(one.command, node, run);
    } else if (run.leads) {
      wait_for_mesh(std::move(one));
    }
  }
}

void CommandServer::answer(const core::Command& command, const core::Ray& ray, const node::Node& node) {
  const bool asked = ray.regions.empty() || std::ranges::find(ray.regions, region_) != ray.regions.end();
  if (!asked) return;
  const physics::RayHit hit = node.world().cast(ray.from_W, ray.to_W);
  core::CommandReply seen;
  seen.request = command.request;
  seen.outcome = core::Outcome::kSeen;
  seen.at_step = node.current_step();
  seen.object = hit.object;
  seen.p_W = hit.p_W;
  seen.normal_W = hit.normal_W;
  seen.distance_m = hit.distance_m;
  endpoint_.reply(std::move(seen));
}

/// A mesh is on its way to all nodes; after some seconds it is not.
void CommandServer::wait_for_mesh(Asked asked) {
  if (++asked.rounds > kRoundsForMesh) {
    refuse(asked.command, "not every node has got the mesh; was it sent to /api/shapes?");
  } else {
    waiting_for_mesh_.push_back(std::move(asked));
  }
}

bool CommandServer::has_mesh(std::uint64_t hash) {
  if (std::ranges::find(meshes_, hash) != meshes_.end()) return true;
  if (mesh_reader_.mesh(hash) == nullptr) return false;
  meshes_.push_back(hash);
  return true;
}

void CommandServer::refuse(const core::Command& command, std::string why) {
  core::CommandReply reply;
  reply.request = command.request;
  reply.outcome = core::Outcome::kRefused;
  reply.text = std::move(why);
  endpoint_.reply(std::move(reply));
}

void CommandServer::accept(const core::Command& command, const core::Order& order,
                           std::optional<core::ObjectRef> object) {
  core::CommandReply reply;
  reply.request = command.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = order.at_step;
  reply.object = object;
  endpoint_.reply(std::move(reply));
  const bool of_a_body = core::body_of(order.action) || std::holds_alternative<core::Spawn>(order.action);
  if (of_a_body) return;  // what was done to bodies is replied by their hosts
  // A change of the run is done when the run goes on after it.
  due_[command.request] = closed_ ? std::numeric_limits<core::Step>::max() : order.at_step;
}

void CommandServer::decide(const core::Command& command, node::Node& node, const RunView& run) {
  const bool changes_the_run = core::changes_the_run(command.ask);
  if (closed_) return refuse(command, "the run is being changed; ask again in a moment");
  if (changes_the_run && !run.complete) return refuse(command, "a node has died: the run can only go on as it is");
  const core::ClientShape* const own_shape = shape_in(command.ask);
  const CommandContext context{launch_, node.scene(), run.bodies,
                               own_shape != nullptr ? make_shape(*own_shape) : std::nullopt};
  if (std::string why = problem_with(command.ask, context); !why.empty()) return refuse(command, std::move(why));
  if (const auto* body = std::get_if<core::NewBody>(&command.ask)) return spawn(command, *body, node);
  if (const auto* fixed = std::get_if<core::NewStatic>(&command.ask)) return place(command, *fixed, node);
  const core::Action action = std::visit(
      [](const auto& ask) -> core::Action {
        if constexpr (std::is_constructible_v<core::Action, decltype(ask)>) {
          return ask;
        } else {
          return core::RemoveBody{};  // a new body, a new static or a ray: not here
        }
      },
      command.ask);
  closed_ = changes_the_run;
  accept(command, node.order(action, command.request, command.at_step));
}

void CommandServer::spawn(const core::Command& command, const core::NewBody& body, node::Node& node) {
  const core::PrototypeId prototype = prototype_id(body, command.request, node);
  const core::BodyId id{core::kFirstClientBody + node.protocol().last_order() + 1};
  const core::Spawn spawn{id, prototype, body.pose, body.v_WB, body.w_WB};
  accept(command, node.order(spawn, command.request, command.at_step), core::ref_of(id));
}

void CommandServer::place(const core::Command& command, const core::NewStatic& fixed, node::Node& node) {
  const std::uint32_t shape = shape_index(fixed.shape, command.request, node);
  const core::StaticId id{static_cast<std::uint32_t>(statics_++)};
  accept(command, node.order(core::AddStatic{id, shape, fixed.pose}, command.request, command.at_step),
         core::ref_of(id));
}

std::uint32_t CommandServer::shape_index(const core::ClientShape& shape, std::uint64_t request, node::Node& node) {
  for (const OwnShape& known : own_shapes_) {
    if (std::visit(Same{}, known.shape, shape)) return known.index;
  }
  node.order(core::DefineShape{shape}, request);
  own_shapes_.push_back({shape, static_cast<std::uint32_t>(shapes_++)});
  return own_shapes_.back().index;
}

core::PrototypeId CommandServer::prototype_id(const core::NewBody& body, std::uint64_t request, node::Node& node) {
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

std::optional<core::Shape> CommandServer::make_shape(const core::ClientShape& shape) {
  if (const auto* mesh = std::get_if<core::MeshRef>(&shape)) return make_mesh(*mesh);
  return std::visit(
      [](const auto& s) -> core::Shape {
        if constexpr (std::is_constructible_v<core::Shape, decltype(s)>) {
          return s;
        } else {
          return core::Sphere{};  // a mesh: not here
        }
      },
      shape);
}

std::optional<core::Shape> CommandServer::make_mesh(const core::MeshRef& ref) {
  const core::TriangleMesh* const mesh = mesh_reader_.mesh(ref.hash);
  return mesh == nullptr ? std::nullopt : std::optional(config::shape_for(*mesh, ref.use));
}

/// Publishes what the scene has got, when it has got something.
void CommandServer::publish_additions(const node::StepReport& report) {
  const std::size_t before = additions_.orders.size();
  for (const core::Order& order : report.orders) {
    if (node::changes_scene(order.action)) additions_.orders.push_back(order);
  }
  if (additions_.orders.size() > before && leads_) additions_writer_.send(additions_);
}

void CommandServer::reply_done(std::uint64_t request, core::Step step) {
  core::CommandReply done;
  done.request = request;
  done.outcome = core::Outcome::kDone;
  done.at_step = step;
  endpoint_.reply(std::move(done));
}

void CommandServer::reply_all_done(core::Step step) {
  for (const auto& [request, due] : std::exchange(due_, {})) reply_done(request, step);
}

void CommandServer::after_step(const node::StepReport& report) {
  publish_additions(report);
  for (const std::uint64_t request : report.applied) reply_done(request, report.step);
  std::erase_if(due_, [&](const auto& entry) {
    if (entry.second > report.step) return false;
    reply_done(entry.first, report.step);
    return true;
  });
}

}  // namespace aurasim::cli
