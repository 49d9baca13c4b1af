// How a world comes into a node: the scene's, a saved one, or an earlier state of its own. In each case the node puts
// in its part of one state (a Cut), and publishes that state. Under another map the present state is published anew.
#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include "core/horizon.h"
#include "core/united.h"
#include "node/node.h"
#include "node/saved_world_check.h"
#include "node/scene_additions.h"

namespace aurasim::node {

core::WorldCut first_world(const core::Scene& scene, int lookahead, double step_s) {
  core::WorldCut world;
  world.births_known = core::horizon::birth_notice(lookahead);
  std::vector<core::BodyRecord>& records = world.bodies.bodies;
  for (const core::InitialBody& body : scene.bodies) records.push_back(core::initial_record(body));
  for (core::BodyRecord& record : Injections().between(scene, 0, world.births_known, step_s)) {
    records.push_back(std::move(record));
  }
  std::ranges::sort(records, {}, &core::BodyRecord::id);
  return world;
}

const StepReport& Node::start() {
  return start(first_world(scene(), setup_.protocol.aura.lookahead, setup_.physics.step_s));
}

const StepReport& Node::start(core::WorldCut world, Recorded recorded) {
  report_ = {};
  held_.begin_step();
  const bool is_later = world.step != setup_.protocol.start || world.last_order != setup_.protocol.last_order;
  setup_.protocol.start = world.step;
  setup_.protocol.last_order = world.last_order;
  beginning_ = Beginning{std::move(world), {}};
  execute_saved(beginning_->world);
  world_.moves().give_up_expected(setup_.protocol.start + 1);
  if (is_later) protocol_.emplace(setup_.protocol, *map_, *clearance_);  // else it may have announced orders already
  const Cut part{setup_.protocol.start, core::ChangedState(our_part()), {}, to_be_born_, watch_.counts()};
  protocol_->listen_to(setup_.protocol.related);
  put_in(part);
  for (const core::BodyRecord& body : part.bodies.now.bodies) {
    report_.births.push_back({body.id, body.birth});
    if (body.birth > part.step && !protocol_->computes_again()) watch_.newborn(body.id, body.birth);
  }
  begin_state(recorded);
  take_cut();
  if (!may_go_back()) beginning_.reset();
  order_recorded_moves();
  hold();
  return report_;
}

const StepReport& Node::take_map(const core::ProtocolSettings& settings, const core::RegionMap& map,
                                 transport::Transport& transport, core::SeamMail* seams) {
  clear_report();
  held_.begin_step();
  confirm_all();
  const std::uint64_t last_order = protocol_->last_order();
  setup_.protocol = settings;
  setup_.protocol.start = current_step();
  setup_.protocol.last_order = last_order;
  settled_ = false;
  is_changing_ = false;
  map_ = &map;
  transport_ = &transport;
  inbox_.clear();
  setup_.seams = seams;
  if (seams != nullptr) couple();  // blocks have other owners, to which bodies go in the next step
  protocol_.emplace(setup_.protocol, map, *clearance_);
  begin_state(Recorded::kYes);
  take_cut();
  hold();
  return report_;
}

void Node::couple() {
  owners_.emplace(physics::block_owners(*map_, scene(), setup_.physics));
  setup_.protocol.owners = &*owners_;
  partners_.emplace(*owners_);
  world_.couple({region(), &*owners_, setup_.seams, &*partners_});
}

/// Puts this region's part of a state into the world, with the clusters that had been sent here in that state or
/// before and join later.
void Node::put_in(const Cut& part) {
  if (part.bodies.before == nullptr) {
    world_.put_back(part.step, part.bodies.now);
  } else {
    world_.put_back(part.step, core::whole(part.bodies));
  }
  watch_.put_back(part.collisions);
  to_be_born_ = part.to_be_born;
  std::vector<const core::Adoption*> joining;
  for (const core::Adoption& adoption : part.joining) joining.push_back(&adoption);
  adopt(joining);
}

/// Publishes the state that has been put in. Its hash is reported unless the records have it already.
void Node::begin_state(Recorded recorded) {
  const bool hashes = std::exchange(setup_.hash_states, setup_.hash_states && recorded == Recorded::kNo);
  finish_state();
  setup_.hash_states = hashes;
}

/// Executes the orders of a saved world: the scene gets its additions again, and orders for later states are scheduled.
/// Collects in beginning_ the bodies that are born so soon that they could not be announced in time.
void Node::execute_saved(const core::WorldCut& world) {
  check_orders(world, scene());
  for (const core::Setpoints& said : world.setpoints) world_.controls().recall(said);
  const MeshSource from_saved = [&world, others = scene_.meshes()](const core::MeshRef& mesh) {
    const auto found = std::ranges::find(world.shapes, mesh, &core::SavedShape::mesh);
    if (found != world.shapes.end()) return std::optional(found->shape);
    return others ? others(mesh) : std::nullopt;
  };
  MeshSource before = scene_.use_meshes(from_saved);
  // Known in the first state, whatever lookahead the world was saved with.
  const core::Step soon =
      std::max(world.step + core::horizon::birth_notice(setup_.protocol.aura.lookahead), world.births_known);
  std::vector<core::BodyRecord>& born_soon = beginning_->born_soon;
  for (const core::Order& order : world.orders) {
    const auto* const spawn = std::get_if<core::Spawn>(&order.action);
    execute(order);
    if (spawn == nullptr || order.at_step > soon) continue;
    to_be_born_.spawns.pop_back();
    world_.schedule(order);  // its shape may be new
    if (order.at_step > world.births_known) born_soon.push_back(record_of(*spawn, order.at_step));
  }
  scene_.use_meshes(std::move(before));
  const double step_s = setup_.physics.step_s;
  for (const core::BodyRecord& body : injections_.between(scene(), world.births_known, soon, step_s)) {
    born_soon.push_back(body);
  }
  to_be_born_.injected = soon;
  check_bodies(world, scene());
}

/// The bodies of the world of the beginning that this region hosts. The world is put together as if on one node, and
/// then divided by the map.
core::ClusterState Node::our_part() {
  const core::WorldCut& world = beginning_->world;
  world_.put_back(world.step, world.bodies);
  std::map<core::Step, core::ClusterState> late;  // by stamp: those of one stamp make up the states together
  for (const core::UnderWay& one : world.under_way) core::append(late[one.stamp], one.cluster);
  for (auto& [stamp, clusters] : late) {
    core::put_in_order(clusters);
    world_.adopt(clusters, stamp);
  }
  world_.add(beginning_->born_soon);
  const core::Snapshot all = world_.snapshot();
  const std::vector<core::RegionId> hosts = hosts_at_start(all);
  std::vector<core::BodyId> ours;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    if (hosts[i] == region()) ours.push_back(all.bodies[i].id);
  }
  core::ClusterState part = owners_ ? world_.peek_whole(ours) : world_.peek(ours);
  for (core::BodyRecord& body : part.bodies) body.epoch += first_epoch_;
  return part;
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
  if (owners_) {
    std::vector<core::RegionId> hosts;
    for (const core::BodyRecord& body : world_.peek_all().bodies) hosts.push_back(owners_->owner(body.block));
    return hosts;
  }
  std::vector<core::RegionId> hosts = core::assign_hosts(*map_, setup_.protocol.aura, *clearance_, all);
  setup_.protocol.related.clear();
  for (const core::RegionId related :
       core::related_at_start(protocol_->aura(), *map_, setup_.protocol.neighbour_distance_m, region(), all, hosts)) {
    setup_.protocol.related.push_back({related, setup_.protocol.start, {}});
  }
  return hosts;
}

}  // namespace aurasim::node
