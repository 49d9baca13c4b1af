// The interest of one observer in a run: which bodies, in which states, and whether also contacts and joints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// A box with sides along the world's axes, metres. A point on a side is inside.
struct WorldBox {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();

  bool holds(const Vec3& p_W) const { return (p_W.array() >= low.array() && p_W.array() <= high.array()).all(); }
};

struct Interest {
  std::uint64_t client = 0;    ///< random number of the observer
  std::uint64_t sequence = 1;  ///< number of the client's interest, from 1: the highest replaces all others
  std::uint32_t every = 1;     ///< wants states whose number is a multiple of it; 0: those in which the run is paused
  bool contacts = false;       ///< wants the contacts of the wanted bodies
  bool joints = false;         ///< wants the joints of the wanted bodies
  bool ended = false;          ///< the observer wants nothing any more
  // A body is wanted for any of these reasons.
  bool all = false;
  std::vector<BodyId> bodies;           ///< ascending
  std::vector<PrototypeId> prototypes;  ///< ascending
  std::vector<WorldBox> boxes;          ///< the body's origin is in one of them

  bool wants(BodyId id, PrototypeId prototype, const Vec3& p_WB) const;
  /// Is state `step` of a run that goes on wanted?
  bool is_for(Step step) const { return every > 0 && step % every == 0; }
};

// Limits of one interest, and of the number of observers of a node.
inline constexpr std::size_t kMostWantedBodies = 100'000;
inline constexpr std::size_t kMostWantedPrototypes = 10'000;
inline constexpr std::size_t kMostWantedBoxes = 256;
inline constexpr std::uint32_t kMostStatesBetween = 1'000'000;
inline constexpr double kFarthestBox_m = 1e9;
inline constexpr std::size_t kMostObservers = 64;

}  // namespace aurasim::core
