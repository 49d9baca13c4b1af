#include "physics/simulation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "core/keep_one_of_each.h"
#include "core/progress.h"
#include "physics/bullet_convert.h"
#include "physics/construction.h"
#include "physics/moving_body.h"
#include "physics/part_surfaces.h"
#include "physics/prefetch.h"
#include "physics/soft/threads.h"
#include "physics/spare_memory.h"

namespace aurasim::physics {
namespace {

/// Half of the shortest side of the shape's bounding box, m: radius of the ball that Bullet sweeps for the body.
btScalar half_thickness(const btCollisionShape& shape) {
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const btVector3 sides = high - low;
  return sides[sides.minAxis()] / 2;
}

/// A world of fewer bodies does not leave much memory behind.
constexpr std::size_t kManyBodies = 4096;

constexpr std::uint64_t kRoomForStatics = 1U << 20U;

/// A body that this world hosts: neither static nor a guest.
bool is_ours(const btRigidBody& body) { return !body.isStaticObject() && !is_guest(body); }

[[noreturn]] void refuse_twin(core::BodyId id) {
  throw std::invalid_argument("body " + std::to_string(core::value_of(id)) + " is here already");
}

void refuse_twins(const std::vector<HostedBody>& bodies) {
  std::vector<core::BodyId> ids;
  for (const HostedBody& body : bodies) ids.push_back(body.id);
  std::sort(ids.begin(), ids.end());
  const auto twin = std::adjacent_find(ids.begin(), ids.end());
  if (twin != ids.end()) refuse_twin(*twin);
}

}  // namespace

Simulation::Simulation(const core::Scene& scene, const Settings& settings, std::shared_ptr<const ShapeSet> shapes,
                       std::shared_ptr<const StaticPlaces> places, const Timeline& timeline)
    : scene_(&scene),
      settings_(settings),
      shapes_(std::move(shapes)),
      timeline_(timeline),
      statics_(scene, shapes_, std::move(places), world_),
      joints_(scene, settings),
      world_(scene.gravity, settings) {
  notes_.give_up_copy();
  world_.use(&statics_);
  show_statics(step_);
}

Simulation::~Simulation() = default;

/// Rank of a body: statics come first, then bodies by id. Ranks never change, so there is room for later statics.
int Simulation::rank_of(core::BodyId id) const {
  const auto room = static_cast<std::uint64_t>(std::numeric_limits<int>::max()) - kRoomForStatics - 1;
  if (core::value_of(id) > room) {
    throw std::invalid_argument("body id " + std::to_string(core::value_of(id)) + " is above " + std::to_string(room) +
                                ", the largest that Bullet's broadphase can tell apart");
  }
  return static_cast<int>(core::value_of(id) + kRoomForStatics + 1);
}

bool Simulation::contains(core::BodyId id) const {
  const HostedBody* const body = table_.find(id);
  return body != nullptr && !is_guest(*body->rigid);
}

void Simulation::start_at(core::Step step) {
  assert(table_.size() == 0);
  step_ = step;
  joints_.forget();
  if (timeline_.statics_change()) show_statics(step);
  place_moving_statics();
  note_all();
}

HostedBody Simulation::make_body(const core::BodyRecord& record) {
  if (table_.find(record.id) != nullptr) refuse_twin(record.id);
  rank_of(record.id);  // or throws
  const core::Prototype& prototype = scene_->prototypes.at(core::value_of(record.prototype));
  auto info = construction_of(prototype.mass_kg, shapes_->shape(prototype.shape), shapes_->inertia(record.prototype),
                              scene_->materials.at(prototype.material));

  HostedBody body{
      record.id, record.epoch, record.prototype, record.birth, false, false, std::make_unique<MovingBody>(info)};
  body.rigid->setFlags(0);  // no gyroscopic torque: see free_rotation.h
  use_part_surfaces(*body.rigid);
  if (settings_.continuous) {
    const btScalar thin = half_thickness(*body.rigid->getCollisionShape());
    body.rigid->setCcdMotionThreshold(thin);
    body.rigid->setCcdSweptSphereRadius(btScalar(0.9) * thin);
  }
  set_motion(*body.rigid, record);
  return body;
}

/// Gives a body the state of a record, whatever its state was before.
void Simulation::set_motion(btRigidBody& rigid, const core::BodyRecord& record) {
  rigid.setLinearVelocity(to_bullet(record.v_WB));
  rigid.setAngularVelocity(to_bullet(record.w_WB));
  rigid.setCenterOfMassTransform(btTransform(to_bullet(record.R_WB), to_bullet(record.p_WB)));
  rigid.clearForces();
  const bool can_sleep = scene_->prototypes[core::value_of(record.prototype)].can_sleep;
  const bool keeps_state = can_sleep || record.activation_state == DISABLE_SIMULATION;
  rigid.forceActivationState(keeps_state ? record.activation_state : DISABLE_DEACTIVATION);
  rigid.setDeactivationTime(static_cast<btScalar>(record.deactivation_time));
  // The soft step stops a sleeper that comes with a velocity.
  const bool is_still = record.v_WB.isZero(0) && record.w_WB.isZero(0);
  will_stop_sleepers_ = will_stop_sleepers_ || (!rigid.isActive() && !is_still);
  place_of(rigid).id = record.id;
  place_of(rigid).block = record.block.is_known() ? record.block : core::block_at(record.p_WB, settings_.block_m);
}

void Simulation::add(std::span<const core::BodyRecord> bodies) {
  put_in(bodies);
  insert_born();
  settle_blocks();
}

void Simulation::put_in(std::span<const core::BodyRecord> bodies) {
  std::vector<HostedBody> arrivals;
  arrivals.reserve(bodies.size());
  for (const core::BodyRecord& record : bodies) arrivals.push_back(make_body(record));
  refuse_twins(arrivals);
  insert(std::move(arrivals));
  for (const core::BodyRecord& record : bodies) note_new(record.id);
}

/// Puts bodies into the table. They wait for insert_born().
void Simulation::insert(std::vector<HostedBody> arrivals) {
  forget_moved();
  findings_.forget();
  for (const HostedBody& body : arrivals) unborn_.push_back(body.id);
  table_.insert(std::move(arrivals));
  next_birth_ = std::min(next_birth_, step_);  // they have not been asked yet
}

void Simulation::insert_born() {
  if (step_ < next_birth_) return;
  next_birth_ = std::numeric_limits<core::Step>::max();
  core::keep_one_of_each(unborn_);
  std::size_t near = 0;
  std::erase_if(unborn_, [&](core::BodyId id) {
    HostedBody* const body = table_.find(id, near);
    if (body == nullptr || body->born) return true;  // it has left, and may have come back
    if (body->birth > step_) {
      next_birth_ = std::min(next_birth_, body->birth);
      return false;
    }
    note_new(body->id);
    world_.insert(*body->rigid, rank_of(body->id), scene_->prototypes[core::value_of(body->prototype)].collides);
    body->born = true;
    if (!is_guest(*body->rigid)) joints_.connect(body->id, table_, world_);
    return true;
  });
}

void Simulation::join(const core::ClusterState& cluster) {
  put_in(cluster.bodies);
  joints_.restore(cluster, table_);
  insert_born();
  restore_contacts(cluster);
  for (const core::ManifoldRecord& manifold : cluster.manifolds) notes_.note_pair(manifold.object0, manifold.object1);
}

/// The body or static of a reference; null if it is not here.
btRigidBody* Simulation::find_object(core::ObjectRef ref) {
  if (ref < 0) {
    const auto index = static_cast<std::uint32_t>(-1 - ref);
    return statics_.is_in(index) ? statics_.find(index) : nullptr;
  }
  const HostedBody* const body = table_.find(core::BodyId{static_cast<std::uint64_t>(ref)});
  return body != nullptr && body->born ? body->rigid.get() : nullptr;
}

/// The same, with statics of which no body has been near yet.
btRigidBody* Simulation::bring_object(core::ObjectRef ref) {
  if (ref < 0 && -1 - ref < static_cast<core::ObjectRef>(statics_.size())) {
    statics_.hold(static_cast<std::uint32_t>(-1 - ref));
  }
  return find_object(ref);
}

core::ObjectRef Simulation::ref_of(const btCollisionObject& object) const {
  const int index = object.getUserIndex();
  if (is_static(index)) return index;  // -1 - its id, as in an ObjectRef
  return core::ref_of(table_[static_cast<std::size_t>(index)].id);
}

/// Restores the contact caches of a cluster. Two compounds may have manifolds in both orders of the bodies, so records
/// are grouped by pair first.
void Simulation::restore_contacts(const core::ClusterState& cluster) {
  std::vector<std::uint32_t> order(cluster.manifolds.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto pair_of = [&](std::uint32_t i) {
    return std::minmax(cluster.manifolds[i].object0, cluster.manifolds[i].object1);
  };
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return pair_of(i) < pair_of(j); });
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && pair_of(order[last]) == pair_of(order[first])) ++last;
    restore_pair(cluster, std::span(order).subspan(first, last - first));
  }
}

void Simulation::restore_pair(const core::ClusterState& cluster, std::span<const std::uint32_t> records) {
  const core::ManifoldRecord& any = cluster.manifolds[records.front()];
  btRigidBody* const a = bring_object(any.object0);
  btRigidBody* const b = bring_object(any.object1);
  if (coupling_ != nullptr && (a == nullptr || b == nullptr)) return restore_later(cluster, records);
  if (a == nullptr || b == nullptr || a == b || !(is_ours(*a) || is_ours(*b))) return;
  core::Progress::mark();
  world_.make_manifolds(*a, *b, of_pair_);
  for (const std::uint32_t index : records) {
    const core::ManifoldRecord& record = cluster.manifolds[index];
    if (record.point_count == 0) continue;
    const btRigidBody* const body0 = record.object0 == any.object0 ? a : b;
    const btRigidBody* const body1 = body0 == a ? b : a;
    const double* row = &cluster.points.at(record.first_point * core::kContactPointDoubles);
    const Parts parts =
        parts_of(row, body0->getCollisionShape()->isCompound(), body1->getCollisionShape()->isCompound());
    btPersistentManifold* const made =
        restore_points(of_pair_, *body0, parts, std::span(row, record.point_count * core::kContactPointDoubles));
    if (made != nullptr) world_.first_contacts().know(*made);
  }
}

std::size_t Simulation::body_count() const {
  if (coupling_ == nullptr) return table_.size();
  return static_cast<std::size_t>(
      std::ranges::count_if(table_.bodies(), [](const HostedBody& body) { return !is_guest(*body.rigid); }));
}

std::vector<core::BodyId> Simulation::body_ids() const {
  std::vector<core::BodyId> ids;
  for (const HostedBody& body : table_.bodies()) {
    if (!is_guest(*body.rigid)) ids.push_back(body.id);
  }
  return ids;
}

void Simulation::step() {
  world_.first_contacts().clear();
  world_.contact_impulses().clear();
  statics_.drop_some();
  apply_orders(step_ + 1);
  heed_setpoints(step_ + 1);
  start_moving_statics();
  for (int i = 0; i < settings_.looks(); ++i) {
    push();
    if (coupling_ != nullptr) meet_neighbours();
    joints_.follow();
    world_.step(settings_.step_s / settings_.looks());
    core::Progress::mark();
    joints_.finish_look(world_);
  }
  note_moved();
  if (used_room_.is_spare(moved_count_)) free_spare_memory();
  findings_.look(table_, notes_.for_step, settings_.block_m, world_.team());
  world_.team().rest();
  stop_pushing();
  ++step_;
  place_moving_statics();
  collect_collisions();
  collect_contact_impulses();
  take_out_what_broke();
  insert_born();
  settle_blocks();
  notes_.for_step.clear();
  findings_.forget();
}

/// Notes the bodies that the step has moved, and their contacts.
void Simulation::note_moved() {
  snapshot_is_fresh_ = records_are_fresh_ = false;
  moved_contacts_.clear();
  moved_.clear();
  if (++steps_since_snapshot_ > 1) notes_.for_snapshot.note_all();  // contacts of the step before are not known
  if (!world_.knows_moved() || std::exchange(will_stop_sleepers_, false)) return notes_.note_all();
  moved_count_ = world_.moved().size();
  const auto place_of = [](const btRigidBody* body) { return static_cast<std::uint32_t>(body->getUserIndex()); };
  moved_.resize(moved_count_);
  world_.team().for_each(moved_count_, [&](std::size_t i) { moved_[i] = place_of(world_.moved()[i]); });
  sort_places(moved_);
  moved_ids_.clear();
  for (const std::uint32_t place : moved_) moved_ids_.push_back(table_[place].id);
  notes_.note_moved(moved_ids_);
  for (const btRigidBody* body : world_.called()) notes_.note(table_[place_of(body)].id);
  if (!notes_.wants_contacts()) return;
  touched_.clear();
  world_.add_contacts_of_moved(touched_);
  const auto ref = [this](int index) -> core::ObjectRef {
    return is_static(index) ? index : core::ref_of(table_[static_cast<std::size_t>(index)].id);
  };
  for (const auto& [a, b] : touched_) {
    notes_.note_pair(ref(a), ref(b));
    if (!is_static(a)) moved_contacts_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
  }
}

/// Frees the memory that steps with many awake bodies have used. What the lists hold stays.
void Simulation::free_spare_memory() {
  notes_.free_spare_memory();
  findings_.free_spare_memory();
  world_.first_contacts().free_spare_memory();
  core::free_memory(touched_, unsorted_contacts_, contacts_before_, copied_contacts_, found_contacts_, collisions_);
  moved_.shrink_to_fit(), moved_ids_.shrink_to_fit(), moved_contacts_.shrink_to_fit();
  snapshot_.changed.shrink_to_fit(), snapshot_.changed_contacts.shrink_to_fit();
  if (table_.size() > kManyBodies) give_memory_back();
}

/// Sorts places in the table, without duplicates. Uses marks for many, because that takes no comparisons.
void Simulation::sort_places(std::vector<std::uint32_t>& places) {
  constexpr std::size_t kBodiesOfPlace = 16;
  if (kBodiesOfPlace * places.size() < table_.size()) return core::keep_one_of_each(places);
  is_moved_.resize(table_.size());
  for (const std::uint32_t place : places) is_moved_[place] = 1;
  places.clear();
  for (std::uint32_t place = 0; place < is_moved_.size(); ++place) {
    if (std::exchange(is_moved_[place], 0) != 0) places.push_back(place);
  }
}

void Simulation::collect_collisions() {
  collisions_.clear();
  for (const FirstContact& found : world_.first_contacts().found()) {
    if (!std::isfinite(found.penetration_m + found.relative_speed_m_s)) continue;  // one of the bodies is breaking down
    const auto [a, b] = std::minmax(found.body0, found.body1);
    if (is_guest(*table_[static_cast<std::size_t>(a)].rigid)) continue;  // its host reports
    collisions_.push_back({step_, table_[static_cast<std::size_t>(a)].id, table_[static_cast<std::size_t>(b)].id,
                           found.penetration_m, found.relative_speed_m_s, from_bullet(found.p_O)});
  }
  const auto pair_of = [](const Collision& c) { return std::tie(c.a, c.b); };
  std::stable_sort(collisions_.begin(), collisions_.end(),
                   [&](const auto& a, const auto& b) { return pair_of(a) < pair_of(b); });
  const auto end = std::unique(collisions_.begin(), collisions_.end(),
                               [&](const auto& a, const auto& b) { return pair_of(a) == pair_of(b); });
  collisions_.erase(end, collisions_.end());
}

}  // namespace aurasim::physics
