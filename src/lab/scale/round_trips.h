// Counts hand-offs that bring a body back to the node that it has just come from. Such hand-offs are wasted work.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/ids.h"

namespace aurasim::lab {

class RoundTrips {
 public:
  /// `within_steps`: a return counts within so many steps (60 for one second).
  explicit RoundTrips(core::Step within_steps) : within_steps_(within_steps) {}

  /// Notes that a body left `source` for `destination` in state `stamp`. To be called in ascending order of stamp for
  /// each body. True if the body returns within the limit to the node that it came from.
  bool add(core::BodyId body, core::RegionId source, core::RegionId destination, core::Step stamp) {
    ++moves_;
    const auto [last, first] = last_.try_emplace(body, Move{source, destination, stamp});
    if (first) return false;
    const bool back = last->second.source == destination && last->second.destination == source &&
                      stamp - last->second.stamp <= within_steps_;
    returns_ += back;
    last->second = {source, destination, stamp};
    return back;
  }

  std::uint64_t moves() const { return moves_; }
  std::uint64_t returns() const { return returns_; }

 private:
  struct Move {
    core::RegionId source, destination;
    core::Step stamp;
  };

  core::Step within_steps_;
  std::uint64_t moves_ = 0;
  std::uint64_t returns_ = 0;
  std::unordered_map<core::BodyId, Move> last_;
};

}  // namespace aurasim::lab
