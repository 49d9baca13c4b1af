#include "physics/region_world.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "physics/scratch_world.h"
#include "physics/simulation.h"

namespace aurasim::physics {

class RegionWorld::Impl {
 public:
  Impl(const core::Scene& scene_in, const Settings& settings)
      : scene(scene_in),
        shapes(std::make_shared<ShapeSet>(scene)),
        places(std::make_shared<StaticPlaces>(scene, *shapes)),
        simulation(scene, settings, shapes, places, timeline),
        scratch(scene, settings, shapes, places, timeline),
        ahead(scene, settings, shapes, places, timeline) {}

  const core::Scene& scene;
  Timeline timeline;
  std::shared_ptr<ShapeSet> shapes;
  std::shared_ptr<const StaticPlaces> places;
  Simulation simulation;
  ScratchWorld scratch;
  ScratchWorld ahead;  ///< for foresee(): clusters that have not joined, whose events are reported when they join
  std::vector<Collision> made_up;  ///< first contacts of clusters that caught up since the last step
  std::vector<Collision> collisions;
};

RegionWorld::RegionWorld(const core::Scene& scene, const Settings& settings)
    : impl_(std::make_unique<Impl>(scene, settings)) {}

RegionWorld::~RegionWorld() = default;
RegionWorld::RegionWorld(RegionWorld&&) noexcept = default;
RegionWorld& RegionWorld::operator=(RegionWorld&&) noexcept = default;

core::Step RegionWorld::step_number() const { return impl_->simulation.step_number(); }

void RegionWorld::add(std::span<const core::BodyRecord> bodies) { impl_->simulation.add(bodies); }

void RegionWorld::adopt(const core::ClusterState& cluster, core::Step stamp, const CatchUpListener& caught_up) {
  if (stamp > step_number()) throw std::invalid_argument("a cluster cannot be adopted before its time");
  if (stamp == step_number()) {
    impl_->simulation.join(cluster);
  } else {
    impl_->simulation.join(impl_->scratch.catch_up(cluster, stamp, step_number(), caught_up, impl_->made_up));
  }
}

std::vector<MadeUpContacts> RegionWorld::foresee(const core::ClusterState& cluster, core::Step stamp,
                                                 const CatchUpListener& caught_up) {
  ScratchWorld& ahead = impl_->ahead;
  std::vector<Collision> seen_when_it_joins;
  if (stamp < step_number()) ahead.catch_up(cluster, stamp, step_number(), caught_up, seen_when_it_joins);
  ahead.take_removed();
  ahead.take_applied();
  ahead.take_declined();
  ahead.take_unbearable();
  return ahead.take_contacts();
}

core::ClusterState RegionWorld::release(std::span<const core::BodyId> bodies) {
  return impl_->simulation.release(bodies);
}

std::vector<core::ClusterState> RegionWorld::release(std::span<const std::span<const core::BodyId>> clusters) {
  return impl_->simulation.release(clusters);
}

core::ClusterState RegionWorld::peek(std::span<const core::BodyId> bodies) const {
  return impl_->simulation.peek(bodies);
}

core::ClusterState RegionWorld::peek_whole(std::span<const core::BodyId> bodies) const {
  return std::move(impl_->simulation.copy_whole({&bodies, 1}).front());
}

core::ClusterState RegionWorld::peek_all() const {
  core::ClusterState all;
  copy_all(all);
  return all;
}

void RegionWorld::copy_all(core::ClusterState& all) const { impl_->simulation.copy_all(all); }

void RegionWorld::copy_all(core::ChangedState& copy) { impl_->simulation.copy_all(copy); }

void RegionWorld::put_back(core::Step step, const core::ClusterState& bodies) {
  impl_->simulation.put_back(step, bodies);
  impl_->made_up.clear();
  impl_->collisions.clear();
  take_removed();
  take_applied();
  take_declined();
  take_unbearable();
}

std::optional<core::Step> RegionWorld::schedule(const core::Order& order) {
  impl_->shapes->extend(impl_->scene);
  const std::optional<core::Step> changed = impl_->timeline.add(order);
  impl_->timeline.forget_before(step_number() - kOrderMemory);
  return changed;
}

const core::StaticMoves& RegionWorld::moves() const { return impl_->timeline.moves(); }
core::StaticMoves& RegionWorld::moves() { return impl_->timeline.moves(); }

std::vector<Removal> RegionWorld::take_removed() {
  std::vector<Removal> removed = impl_->simulation.take_removed();
  const std::vector<Removal> on_the_way = impl_->scratch.take_removed();
  removed.insert(removed.end(), on_the_way.begin(), on_the_way.end());
  return removed;
}

std::vector<std::uint64_t> RegionWorld::take_applied() {
  std::vector<std::uint64_t> applied = impl_->simulation.take_applied();
  const std::vector<std::uint64_t> on_the_way = impl_->scratch.take_applied();
  applied.insert(applied.end(), on_the_way.begin(), on_the_way.end());
  return applied;
}

std::vector<Declined> RegionWorld::take_declined() {
  std::vector<Declined> declined = impl_->simulation.take_declined();
  const std::vector<Declined> on_the_way = impl_->scratch.take_declined();
  declined.insert(declined.end(), on_the_way.begin(), on_the_way.end());
  return declined;
}

std::uint64_t RegionWorld::take_unbearable() {
  return impl_->simulation.take_unbearable() + impl_->scratch.take_unbearable();
}

const std::vector<core::BodySetpoint>& RegionWorld::new_setpoints() const { return impl_->simulation.new_setpoints(); }

core::ControlLog& RegionWorld::controls() { return impl_->timeline.controls(); }
const core::ControlLog& RegionWorld::controls() const { return impl_->timeline.controls(); }

RayHit RegionWorld::cast(const core::Vec3& from_W, const core::Vec3& to_W) const {
  return impl_->simulation.cast(from_W, to_W);
}

std::size_t RegionWorld::held_statics() const { return impl_->simulation.held_statics(); }

bool RegionWorld::contains(core::BodyId id) const { return impl_->simulation.contains(id); }

std::size_t RegionWorld::body_count() const { return impl_->simulation.body_count(); }

void RegionWorld::step() {
  impl_->simulation.step();
  impl_->collisions.swap(impl_->made_up);
  impl_->made_up.clear();
  const std::vector<Collision>& seen = impl_->simulation.collisions();
  impl_->collisions.insert(impl_->collisions.end(), seen.begin(), seen.end());
  std::sort(impl_->collisions.begin(), impl_->collisions.end(), [](const Collision& x, const Collision& y) {
    return std::tie(x.a, x.b, x.step) < std::tie(y.a, y.b, y.step);
  });
}

const core::Snapshot& RegionWorld::snapshot() { return impl_->simulation.snapshot(); }

std::span<const core::BodyRecord> RegionWorld::records() { return impl_->simulation.records(); }

std::uint64_t RegionWorld::hash_sum() { return impl_->simulation.hash_sum(); }

const std::vector<Collision>& RegionWorld::collisions() const { return impl_->collisions; }

void RegionWorld::couple(const Coupling& coupling) { impl_->simulation.couple(coupling); }

std::vector<core::Introduction> RegionWorld::introductions_ahead() { return impl_->simulation.introductions_ahead(); }

const std::vector<Moved>& RegionWorld::arrived() const { return impl_->simulation.arrived(); }
const std::vector<Moved>& RegionWorld::left() const { return impl_->simulation.left(); }

void RegionWorld::watch_contacts(bool wanted) {
  impl_->simulation.watch_contacts(wanted);
  impl_->scratch.watch_contacts(wanted);
  impl_->ahead.watch_contacts(wanted);
}

const std::vector<core::ContactImpulse>& RegionWorld::contact_impulses() const {
  return impl_->simulation.contact_impulses();
}

std::vector<MadeUpContacts> RegionWorld::take_made_up_contacts() { return impl_->scratch.take_contacts(); }

std::uint64_t RegionWorld::severed_contacts() const { return impl_->simulation.severed_contacts(); }

}  // namespace aurasim::physics
