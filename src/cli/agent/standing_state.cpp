#include "cli/agent/standing_state.h"

#include <algorithm>
#include <utility>

namespace aurasim::cli::agent {

void StandingState::accept(core::Replica replica) {
  if (!replica.key_frame || replica.generation != generation_ || replica.stamp < at_least_) return;
  const auto known = frames_.find(replica.source);
  if (known == frames_.end() || known->second.stamp <= replica.stamp) {
    frames_.insert_or_assign(replica.source, std::move(replica));
  }
}

void StandingState::accept(const core::Observation& observation) {
  core::Replica frame;
  frame.source = observation.source;
  frame.generation = observation.generation;
  frame.stamp = observation.stamp;
  frame.key_frame = true;
  if (frame.generation != generation_ || frame.stamp < at_least_) return;
  for (const core::ObservedBody& body : observation.bodies) frame.bodies.push_back(body.row);
  for (const core::BodyId id : observation.outside) frame.removed.push_back({id, 0});
  accept(std::move(frame));
}

core::Step StandingState::step() const {
  core::Step newest = at_least_;
  for (const auto& [source, frame] : frames_) newest = std::max(newest, frame.stamp);
  return newest;
}

bool StandingState::is_complete(const std::set<core::RegionId>& regions) const {
  if (regions.empty()) return false;
  return std::ranges::all_of(regions, [this](core::RegionId region) {
    const auto frame = frames_.find(region);
    return frame != frames_.end() && frame->second.stamp == step();
  });
}

std::vector<WorldBody> StandingState::bodies() const {
  std::vector<WorldBody> all;
  std::set<core::BodyId> removed;
  for (const auto& [source, frame] : frames_) {
    if (frame.stamp != step()) continue;  // of a region that has died
    for (const core::ReplicaBody& row : frame.bodies) all.push_back({row, row.host != source});
    for (const core::RemovedBody& body : frame.removed) removed.insert(body.id);
  }
  // It has arrived, and was taken out since: who has handed it over cannot know.
  std::erase_if(all, [&](const WorldBody& body) { return body.under_way && removed.contains(body.row.id); });
  std::ranges::stable_sort(all, [](const WorldBody& a, const WorldBody& b) {
    if (a.row.id != b.row.id) return a.row.id < b.row.id;
    return a.row.epoch != b.row.epoch ? a.row.epoch > b.row.epoch : a.under_way < b.under_way;
  });
  const auto same = [](const WorldBody& a, const WorldBody& b) { return a.row.id == b.row.id; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

}  // namespace aurasim::cli::agent
