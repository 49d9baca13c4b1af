// Finds out which of a run's worlds a run command is for. Each reset, change and recovery begins another world with a
// generation of its own, and nodes begin it at different times. Uses no clock and no DDS.
#pragma once

#include <cstdint>
#include <optional>

#include "core/ids.h"

namespace aurasim::process {

enum class WorldMeant : std::uint8_t {
  kPresent,
  kNext,  ///< a world that has not begun here and is known to come
  kPast,  ///< a world that all have left for that of the newest restore
  kOver   ///< any other world
};

/// The generations that a node knows.
struct Worlds {
  std::optional<core::Generation> begun{};      ///< generation that the node computes, or has computed last
  std::optional<core::Generation> waits_for{};  ///< generation that waits for its start
  std::optional<core::Generation> restored{};   ///< generation of the newest restore
  std::optional<core::Generation> reset_to{};   ///< generation of a reset to come
};

WorldMeant world_meant(core::Generation meant, const Worlds& known);

}  // namespace aurasim::process
