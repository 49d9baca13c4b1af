#include "physics/scratch_world.h"

namespace aurasim::physics {

ScratchWorld::ScratchWorld(const core::Scene& scene, const Settings& settings, std::shared_ptr<const ShapeSet> shapes,
                           std::shared_ptr<const StaticPlaces> places, const Timeline& timeline)
    : scene_(&scene),
      settings_(settings),
      shapes_(std::move(shapes)),
      places_(std::move(places)),
      timeline_(timeline) {}

std::vector<Removal> ScratchWorld::take_removed() {
  return simulation_ ? simulation_->take_removed() : std::vector<Removal>{};
}

std::vector<std::uint64_t> ScratchWorld::take_applied() {
  return simulation_ ? simulation_->take_applied() : std::vector<std::uint64_t>{};
}

std::vector<Declined> ScratchWorld::take_declined() {
  return simulation_ ? simulation_->take_declined() : std::vector<Declined>{};
}

std::uint64_t ScratchWorld::take_unbearable() { return simulation_ ? simulation_->take_unbearable() : 0; }

core::ClusterState ScratchWorld::catch_up(const core::ClusterState& cluster, core::Step from, core::Step to,
                                          const CatchUpListener& caught_up, std::vector<Collision>& collisions) {
  if (!simulation_) simulation_.emplace(*scene_, settings_, shapes_, places_, timeline_);
  simulation_->watch_contacts(watches_contacts_);
  simulation_->start_at(from);
  simulation_->join(cluster);
  while (simulation_->step_number() < to) {
    simulation_->step();
    collisions.insert(collisions.end(), simulation_->collisions().begin(), simulation_->collisions().end());
    if (watches_contacts_) contacts_.push_back({simulation_->step_number(), simulation_->contact_impulses()});
    if (caught_up) caught_up(simulation_->step_number(), simulation_->records());
  }
  return simulation_->release(simulation_->body_ids());
}

}  // namespace aurasim::physics
