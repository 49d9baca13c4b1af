// Bodies of a whole state, from what the regions tell of it. No clock, no wire.
#pragma once

#include <vector>

#include "core/observation.h"
#include "core/replica.h"

namespace aurasim::cli::agent {

/// A body of a whole world.
struct WorldBody {
  core::ReplicaBody row;
  bool under_way = false;  ///< handed over, and its next host does not compute it yet in this state
};

/// Of one state.
using Observations = std::vector<const core::Observation*>;

/// Ascending by id. The highest epoch counts. Under one epoch a row of this state counts before one of when the body
/// left, and that of its host before that of its former host.
std::vector<WorldBody> bodies_of(const Observations& told);

/// Bodies under way of which nobody tells where they are in this state. Ascending.
std::vector<core::BodyId> missing_in(const Observations& told);

}  // namespace aurasim::cli::agent
