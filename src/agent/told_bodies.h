// Puts the bodies of a state together from the observations of all regions. Uses no clock and no network.
#pragma once

#include <vector>

#include "core/observation.h"
#include "core/replica.h"

namespace aurasim::agent {

/// A body of a whole world.
struct WorldBody {
  core::ReplicaBody row;
  bool under_way = false;  ///< the body was handed over, and its next host does not compute it yet in this state
};

/// Observations of one state.
using Observations = std::vector<const core::Observation*>;

/// The bodies, ascending by id. The row with the highest epoch counts. With equal epochs, a row of this state counts
/// before one from when the body left, and its host's row before its former host's.
std::vector<WorldBody> bodies_of(const Observations& told);

/// Bodies under way whose place in this state is unknown. Ascending.
std::vector<core::BodyId> missing_in(const Observations& told);

}  // namespace aurasim::agent
