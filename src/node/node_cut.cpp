// How a node hands out its part of the world in a state, and how a run goes on from a whole one (docs/design.md, "The
// cut").
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/scene_additions.h"

namespace aurasim::node {
namespace {

/// So many states after it has taken effect, an order is still kept for bodies that arrive late.
constexpr core::Step kOrderMemory = 3600;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("the saved world does not fit the scene: " + what);
}

/// What an order names has to be there by then.
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

void Node::save(core::Step step) {
  if (step > current_step()) saving_.push_back({step, {}, false, false});
}

/// Before the clusters for the next state are taken in: those that left before a state that is saved are among them.
void Node::note_arrived() {
  for (Saving& saving : saving_) {
    const core::Step wanted = saving.step + setup_.protocol.aura.lookahead;
    saving.is_whole = saving.cut && current_step() + 1 >= wanted && protocol_->missing(wanted).empty();
  }
}

void Node::save_if_due() {
  for (Saving& saving : saving_) {
    if (saving.step == current_step()) saving.cut = cut();
  }
}

/// The orders of a saved world, and what they have made, are those that are known once it is complete.
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

/// Those that have changed the scene, and those for states later than `after`.
void Node::add_orders(core::WorldCut& part, core::Step after) const {
  part.last_order = protocol_->last_order();
  std::size_t shape = first_own_shape_;
  for (const core::Order& order : orders_) {
    if (const auto* defined = std::get_if<core::DefineShape>(&order.action)) {
      const auto* const mesh = std::get_if<core::MeshRef>(&defined->shape);
      if (mesh != nullptr) part.shapes.push_back({*mesh, scene_.shapes[shape].shape});
      ++shape;
    }
    if (changes_scene(order.action) || order.at_step > after) part.orders.push_back(order);
  }
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

/// For worlds that are saved later.
void Node::remember(const core::Order& order) {
  if (core::changes_the_run(order.action) || std::holds_alternative<core::Redo>(order.action) ||
      std::holds_alternative<core::Save>(order.action)) {
    return;
  }
  orders_.push_back(order);
  if (orders_.size() <= 2 * orders_kept_) return;
  std::erase_if(orders_, [&](const core::Order& old) {
    return !changes_scene(old.action) && old.at_step < current_step() - kOrderMemory;
  });
  orders_kept_ = std::max<std::size_t>(orders_kept_, orders_.size());
}

const StepReport& Node::start(core::WorldCut world, Recorded recorded) {
  report_ = {};
  confirmed_.clear();
  begun_with_ = std::move(world);
  heed_saved();
  setup_.protocol.start = begun_with_->step;
  setup_.protocol.last_order = begun_with_->last_order;
  protocol_.emplace(setup_.protocol, *map_, *clearance_);
  const core::ClusterState ours = our_part();
  protocol_->listen_to(setup_.protocol.related);
  world_.put_back(begun_with_->step, ours);
  for (const core::BodyRecord& body : ours.bodies) {
    report_.births.push_back({body.id, body.birth});
    if (body.birth > begun_with_->step) watch_.newborn(body.id, body.birth);
  }
  const bool hashes = std::exchange(setup_.hash_states, setup_.hash_states && recorded == Recorded::kNo);
  finish_state();
  setup_.hash_states = hashes;
  take_cut();
  if (!setup_.protocol.aura.redo) begun_with_.reset();
  hold(report_);
  return report_;
}

/// The scene grows as it had, and later states get what was ordered for them.
void Node::heed_saved() {
  OrderCheck check_order(scene_);
  for (const core::Order& order : begun_with_->orders) check_order.look(order);
  const MeshSource from_saved = [this, others = meshes_](const core::MeshRef& mesh) {
    const auto found = std::ranges::find_if(begun_with_->shapes, [&](const core::SavedShape& shape) {
      return shape.mesh.hash == mesh.hash && shape.mesh.use == mesh.use;
    });
    if (found != begun_with_->shapes.end()) return std::optional(found->shape);
    return others ? others(mesh) : std::nullopt;
  };
  const MeshSource before = std::exchange(meshes_, from_saved);
  const core::Step soon = births_known_at_start();
  for (const core::Order& order : begun_with_->orders) {
    const auto* const spawn = std::get_if<core::Spawn>(&order.action);
    heed(order);
    if (spawn == nullptr || order.at_step > soon) continue;
    to_spawn_.pop_back();
    world_.schedule(order);  // its shape may be new
    if (order.at_step <= begun_with_->births_known) continue;
    const core::InitialBody body{spawn->id, spawn->prototype, spawn->pose, spawn->v_WB, spawn->w_WB};
    born_soon_.push_back(core::initial_record(body, order.at_step));
  }
  meshes_ = before;
  for (const core::Injector& injector : scene_.injectors) {
    const double step_s = setup_.physics.step_s;
    next_injection_.push_back(core::injected_count(injector, soon, step_s));
    for (auto i = core::injected_count(injector, begun_with_->births_known, step_s); i < next_injection_.back(); ++i) {
      if (auto record = core::injected_body(injector, i, step_s)) born_soon_.push_back(*record);
    }
  }
  check(begun_with_->bodies, scene_);
  for (const core::UnderWay& one : begun_with_->under_way) {
    check(one.cluster, scene_);
    if (one.stamp > begun_with_->step) refuse("a cluster left after the state that was saved");
  }
}

/// Who is born up to then is known in the first state, whatever lookahead the world was saved with.
core::Step Node::births_known_at_start() const {
  const core::Step ours = begun_with_->step + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  return std::max(ours, begun_with_->births_known);
}

/// What this region hosts of the saved world: it is put together whole, as if on one node, and taken apart by the map.
core::ClusterState Node::our_part() {
  world_.put_back(begun_with_->step, begun_with_->bodies);
  for (const core::UnderWay& one : begun_with_->under_way) world_.adopt(one.cluster, one.stamp);
  world_.add(born_soon_);
  const core::Snapshot all = world_.snapshot();
  const std::vector<core::RegionId> hosts = hosts_at_start(all);
  std::vector<core::BodyId> ours;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    if (hosts[i] == region()) ours.push_back(all.bodies[i].id);
  }
  core::ClusterState part = world_.release(ours);
  for (core::BodyRecord& body : part.bodies) body.epoch += first_epoch_;
  return part;
}

}  // namespace aurasim::node
