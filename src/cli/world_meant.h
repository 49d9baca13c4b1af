// For which of the worlds that a run goes through a run command is: each reset, change and recovery begins another one,
// with a generation of its own, and nodes begin it one after the other. No clock, no DDS.
#pragma once

#include <cstdint>
#include <optional>

#include "core/ids.h"

namespace aurasim::cli {

enum class WorldMeant : std::uint8_t {
  kPresent,
  kNext,  ///< one that has not begun here, and is known to come
  kPast,  ///< one that all have left for that of the newest restore
  kOver   ///< any other
};

/// What a node knows of them.
struct Worlds {
  std::optional<core::Generation> begun{};      ///< whose states the node computes, or has computed last
  std::optional<core::Generation> waits_for{};  ///< that waits for its start
  std::optional<core::Generation> restored{};   ///< of the newest restore
  std::optional<core::Generation> reset_to{};   ///< of a reset to come
};

WorldMeant world_meant(core::Generation meant, const Worlds& known);

}  // namespace aurasim::cli
