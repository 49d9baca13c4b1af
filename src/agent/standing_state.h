// The state in which a run is paused, bit by bit, from what all regions publish of it. Uses no clock and no network.
//
// Changes are published only for bodies that have moved visibly (node/replica_feed.h). Observations and key frames
// contain all bodies exactly. Every region publishes a key frame for a new reader.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "agent/told_bodies.h"
#include "core/observation.h"
#include "core/replica.h"

namespace aurasim::agent {

class StandingState {
 public:
  /// Ignores states before `at_least`.
  StandingState(core::Generation generation, core::Step at_least) : generation_(generation), at_least_(at_least) {}

  /// Takes in a key frame; other replicas are ignored. It shows bodies under way as they were when they left.
  void accept(const core::Replica& replica);
  /// Takes in an observation: all bodies of a region, or those on their way to it, as they are in this state.
  void accept(core::Observation observation);
  /// True if all bodies of each of these regions are known for one and the same state.
  bool is_complete(const std::set<core::RegionId>& regions) const;
  /// Bodies under way that are only known as they were when they left. Ascending.
  std::vector<core::BodyId> missing() const { return missing_in(told()); }

  core::Generation generation() const { return generation_; }
  core::Step step() const;
  /// Ascending by id (bodies_of).
  std::vector<WorldBody> bodies() const { return bodies_of(told()); }

 private:
  Observations told() const;

  core::Generation generation_;
  core::Step at_least_;
  std::map<core::RegionId, core::Observation> hosted_;
  std::vector<core::Observation> foreseen_;
};

}  // namespace aurasim::agent
