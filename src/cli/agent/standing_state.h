// The state in which a paused run stands, bit by bit, from what all its regions tell of it. No clock, no wire.
//
// What changes is published only where it has moved by more than an eye sees (node/replica_feed.h). An observation has
// everything as it is, and so has a key frame, which every region publishes for whoever has just come.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "cli/agent/told_bodies.h"
#include "core/observation.h"
#include "core/replica.h"

namespace aurasim::cli::agent {

class StandingState {
 public:
  /// Of no earlier state than this one.
  StandingState(core::Generation generation, core::Step at_least) : generation_(generation), at_least_(at_least) {}

  /// Only a key frame counts. It tells of bodies under way where they left.
  void accept(const core::Replica& replica);
  /// All bodies of a region; or those on their way to it, as they are in this state.
  void accept(core::Observation observation);
  /// Each of these regions has given all that it has of one and the same state.
  bool is_complete(const std::set<core::RegionId>& regions) const;
  /// Bodies under way that are shown as they were when they left. Ascending.
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

}  // namespace aurasim::cli::agent
