// All bodies of a world in one state, as an earlier copy of all of them and what has changed since. Copies of many
// states share the earlier one, so a sleeper is copied once.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

struct ChangedState {
  ChangedState() = default;
  explicit ChangedState(ClusterState all) : now(std::move(all)) {}

  std::shared_ptr<const ClusterState> before;  ///< null: `now` has everything
  std::vector<BodyId> replaced;                ///< bodies whose records in `before` do not count; ascending
  std::vector<BodyId> parted;                  ///< bodies whose contacts in `before` do not count; ascending
  ClusterState now;                            ///< what counts instead, and all joints
};

/// Frees memory of `state.now` that is much larger than what it holds. The memory may come from a state in which all
/// bodies had changed.
void free_spare_memory(ChangedState& state);

/// The bodies of the state with all that physics remembers about them.
ClusterState whole(ChangedState state);

}  // namespace aurasim::core
