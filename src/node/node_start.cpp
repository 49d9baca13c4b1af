// How a run begins on a node: with what the scene says, or with a saved world.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/horizon.h"
#include "node/node.h"
#include "node/scene_additions.h"

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

const StepReport& Node::start() {
  report_ = {};
  confirmed_.clear();
  host_initial_bodies();
  finish_state();
  take_cut();
  order_recorded_moves();
  hold(report_);
  return report_;
}

/// Takes the bodies of state 0, and those born so soon after it that they could not be announced in time.
void Node::host_initial_bodies() {
  const core::Step notice = core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  for (const core::Injector& injector : scene_.injectors) {
    next_injection_.push_back(core::injected_count(injector, notice, setup_.physics.step_s));
  }
  const std::vector<core::BodyRecord> ours = initial_bodies();
  protocol_->listen_to(setup_.protocol.related);
  for (const core::BodyRecord& record : ours) {
    report_.births.push_back({record.id, record.birth});
    if (record.birth > 0) watch_.newborn(record.id, record.birth);
  }
  world_.add(ours);
}

/// The host of each body of `all`, in the same order. Pairs that a redo brings together get one host at once. Also
/// notes the regions that have to exchange batches with this one.
std::vector<core::RegionId> Node::hosts_at_start(core::Snapshot all) {
  for (const core::TogetherPair& pair : setup_.protocol.together) {
    const auto a = std::ranges::lower_bound(all.bodies, pair.a, {}, &core::BodyState::id);
    const auto b = std::ranges::lower_bound(all.bodies, pair.b, {}, &core::BodyState::id);
    if (b == all.bodies.end() || a->id != pair.a || b->id != pair.b) continue;
    all.joints.push_back(
        {static_cast<std::uint32_t>(a - all.bodies.begin()), static_cast<std::uint32_t>(b - all.bodies.begin())});
  }
  std::vector<core::RegionId> hosts = core::assign_hosts(*map_, setup_.protocol.aura, *clearance_, all);
  setup_.protocol.related.clear();
  for (const core::RegionId related :
       core::related_at_start(protocol_->aura(), *map_, setup_.protocol.neighbour_distance_m, region(), all, hosts)) {
    setup_.protocol.related.push_back({related, setup_.protocol.start, {}});
  }
  return hosts;
}

core::WorldCut first_world(const core::Scene& scene, int lookahead, double step_s) {
  core::WorldCut world;
  world.births_known = core::horizon::birth_notice(lookahead);
  std::vector<core::BodyRecord>& records = world.bodies.bodies;
  for (const core::InitialBody& body : scene.bodies) records.push_back(core::initial_record(body));
  for (const core::Injector& injector : scene.injectors) {
    const std::uint64_t count = core::injected_count(injector, world.births_known, step_s);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (auto record = core::injected_body(injector, i, step_s)) records.push_back(*record);
    }
  }
  std::ranges::sort(records, {}, &core::BodyRecord::id);
  return world;
}

/// The bodies of the scene's first world that this node hosts.
std::vector<core::BodyRecord> Node::initial_bodies() {
  const std::vector<core::BodyRecord> records =
      first_world(scene_, setup_.protocol.aura.lookahead, setup_.physics.step_s).bodies.bodies;
  core::Snapshot all;
  for (const core::BodyRecord& record : records) all.bodies.push_back(core::state_of(record));
  all.joints = core::joint_pairs(scene_, all.bodies);
  const std::vector<core::RegionId> hosts = hosts_at_start(std::move(all));
  std::vector<core::BodyRecord> ours;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (hosts[i] != region()) continue;
    ours.push_back(records[i]);
    ours.back().epoch = first_epoch_;
  }
  return ours;
}

const StepReport& Node::start(core::WorldCut world, Recorded recorded) {
  report_ = {};
  confirmed_.clear();
  begun_with_ = std::move(world);
  heed_saved();
  world_.moves().give_up_expected(begun_with_->step + 1);
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
  if (!may_go_back()) begun_with_.reset();
  order_recorded_moves();
  hold(report_);
  return report_;
}

/// Executes the orders of a saved world: the scene gets its additions again, and orders for later states are scheduled.
void Node::heed_saved() {
  for (const core::Setpoints& said : begun_with_->setpoints) {
    const auto is_unknown = [&](const core::JointSetpoint& joint) {
      return core::value_of(joint.id) >= scene_.joints.size();
    };
    if (std::ranges::any_of(said.joints, is_unknown)) refuse("setpoints are of a joint that the scene has not");
    world_.controls().recall(said);
  }
  OrderCheck check_order(scene_);
  for (const core::Order& order : begun_with_->orders) check_order.look(order);
  const MeshSource from_saved = [this, others = meshes_](const core::MeshRef& mesh) {
    const auto found = std::ranges::find(begun_with_->shapes, mesh, &core::SavedShape::mesh);
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
    born_soon_.push_back(record_of(*spawn, order.at_step));
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

/// Bodies born up to the returned state are known in the first state, whatever lookahead the world was saved with.
core::Step Node::births_known_at_start() const {
  const core::Step ours = begun_with_->step + core::horizon::birth_notice(setup_.protocol.aura.lookahead);
  return std::max(ours, begun_with_->births_known);
}

/// The bodies of the saved world that this region hosts. The world is put together as if on one node, and then divided
/// by the map.
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
