#include "agent/standing_state.h"

#include <algorithm>
#include <utility>

namespace aurasim::agent {

void StandingState::accept(const core::Replica& replica) {
  if (!replica.key_frame) return;
  core::Observation hosted;
  hosted.source = replica.source;
  hosted.generation = replica.generation;
  hosted.stamp = replica.stamp;
  for (const core::ReplicaBody& row : replica.bodies) hosted.bodies.push_back({row, row.host != replica.source});
  for (const core::RemovedBody& body : replica.removed) hosted.outside.push_back(body.id);
  accept(std::move(hosted));
}

void StandingState::accept(core::Observation observation) {
  if (observation.generation != generation_ || observation.stamp < at_least_) return;
  if (observation.kind == core::Observation::Kind::kMadeUp) {
    foreseen_.push_back(std::move(observation));
    return;
  }
  const auto known = hosted_.find(observation.source);
  if (known == hosted_.end() || known->second.stamp <= observation.stamp) {
    hosted_.insert_or_assign(observation.source, std::move(observation));
  }
}

core::Step StandingState::step() const {
  core::Step newest = at_least_;
  for (const auto& [source, observation] : hosted_) newest = std::max(newest, observation.stamp);
  return newest;
}

bool StandingState::is_complete(const std::set<core::RegionId>& regions) const {
  if (regions.empty()) return false;
  return std::ranges::all_of(regions, [this](core::RegionId region) {
    const auto told = hosted_.find(region);
    return told != hosted_.end() && told->second.stamp == step();
  });
}

/// The observations of this state. Those of a region that has died since may be of an earlier state and are left out.
Observations StandingState::told() const {
  Observations told;
  for (const auto& [source, observation] : hosted_) {
    if (observation.stamp == step()) told.push_back(&observation);
  }
  for (const core::Observation& observation : foreseen_) {
    if (observation.stamp == step()) told.push_back(&observation);
  }
  return told;
}

}  // namespace aurasim::agent
