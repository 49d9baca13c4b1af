// In which state a node of a paused run stands. No clock, no DDS.
#pragma once

#include <cstdint>
#include <vector>

#include "dds/control_messages.h"

namespace aurasim::cli {

/// The steps that clients have asked for in a pause. A step names the state that its sender knew, and how many states
/// it wants. Steps add up, also those of clients that knew the same state: each is as many states more. Nodes may
/// receive them in any order and come to the same state.
class AskedSteps {
 public:
  /// The run stands, or is to stand, in `state`: steps that were asked for before are done or void.
  void begin(core::Step state);
  /// A step command. One of another generation than those before begins anew.
  void add(const dds::RunCommand& step);
  /// Where all of them lead.
  core::Step end() const;

 private:
  struct Asked {
    core::Step from = 0;  ///< the state that the sender knew
    std::uint64_t request = 0;
    std::int64_t count = 0;

    auto operator<=>(const Asked&) const = default;
  };

  core::Generation generation_ = 0;
  core::Step begin_ = 0;
  std::vector<Asked> asked_;  ///< ascending; the newest kMost of them, begin_ has the others
};

}  // namespace aurasim::cli
