// The state in which a paused run stands, bit by bit, from the key frames of all its regions. No clock, no wire.
//
// What changes is published only where it has moved by more than an eye sees (node/replica_feed.h); a key frame has
// everything as it is, and every region publishes one for whoever has just come.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "core/observation.h"
#include "core/replica.h"

namespace aurasim::cli::agent {

/// A body of a whole world.
struct WorldBody {
  core::ReplicaBody row;
  bool under_way = false;  ///< its last host has handed it over, and its next one has not published it yet
};

class StandingState {
 public:
  /// Of no earlier state than this one.
  StandingState(core::Generation generation, core::Step at_least) : generation_(generation), at_least_(at_least) {}

  void accept(core::Replica replica);
  /// All bodies of a region, told by another way.
  void accept(const core::Observation& observation);
  /// Each of these regions has given all that it has of one and the same state.
  bool is_complete(const std::set<core::RegionId>& regions) const;

  core::Generation generation() const { return generation_; }
  core::Step step() const;
  /// Ascending by id. The highest epoch is the truth; under one epoch, that of its host.
  std::vector<WorldBody> bodies() const;

 private:
  core::Generation generation_;
  core::Step at_least_;
  std::map<core::RegionId, core::Replica> frames_;
};

}  // namespace aurasim::cli::agent
