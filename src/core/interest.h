// What one observer wants to be told of a run: which bodies, in which states, and what besides where they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// With sides along the world's axes, m; a point on a side is in it.
struct WorldBox {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();

  bool holds(const Vec3& p_W) const { return (p_W.array() >= low.array() && p_W.array() <= high.array()).all(); }
};

struct Interest {
  std::uint64_t client = 0;    ///< random number of the observer
  std::uint64_t sequence = 1;  ///< of the client's interests, from 1: the highest counts
  std::uint32_t every = 1;     ///< states whose number is a multiple of it; 0: those in which the run stands
  bool contacts = false;       ///< of these bodies
  bool joints = false;         ///< likewise
  bool ended = false;          ///< it wants nothing any more
  // A body is wanted for any of these reasons.
  bool all = false;
  std::vector<BodyId> bodies;           ///< ascending
  std::vector<PrototypeId> prototypes;  ///< ascending
  std::vector<WorldBox> boxes;          ///< the body's origin is in one of them

  bool wants(BodyId id, PrototypeId prototype, const Vec3& p_WB) const;
  /// In state `step` of a run that goes on.
  bool is_for(Step step) const { return every > 0 && step % every == 0; }
};

// So much one observer may ask for, and so many of them a node serves.
inline constexpr std::size_t kMostWantedBodies = 100'000;
inline constexpr std::size_t kMostWantedPrototypes = 10'000;
inline constexpr std::size_t kMostWantedBoxes = 256;
inline constexpr std::uint32_t kMostStatesBetween = 1'000'000;
inline constexpr double kFarthestBox_m = 1e9;
inline constexpr std::size_t kMostObservers = 64;

}  // namespace aurasim::core
