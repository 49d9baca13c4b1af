// Puts the records of several clusters together.
#pragma once

#include "core/body_state.h"

namespace aurasim::core {

/// Adds the records of `from`. The bodies and manifolds of `to` are in order after put_in_order() only.
void append(ClusterState& to, const ClusterState& from);
/// Sorts the bodies and the manifolds, which may have been appended in any order.
void put_in_order(ClusterState& cluster);

}  // namespace aurasim::core
