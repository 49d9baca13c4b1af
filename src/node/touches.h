// Which bodies have had a contact since they came to this node. A hand-off of a body that has touched nothing may be
// thrashing.
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"

namespace aurasim::node {

class Touches {
 public:
  /// Looks at the next state. A body that was not in the state before has not touched anything yet.
  void note(const core::Snapshot& snapshot);
  /// True if the body has had a contact since it came, or since the last call. To be called when it leaves.
  bool take(core::BodyId id);

 private:
  struct Touch {
    core::BodyId id{};
    bool touched = false;
  };
  std::uint64_t seen_ = 0;           ///< number of the last snapshot
  std::vector<Touch> now_, before_;  ///< ascending id: of the last state, and of one before it
};

}  // namespace aurasim::node
