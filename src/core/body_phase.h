// The state machine of a body in Aura Projection (thesis section 4.4). A phase is not the place of a body, but how the
// node treats it.
#pragma once

#include <cstdint>
#include <optional>

namespace aurasim::core {

enum class Phase : std::uint8_t {
  kInjected,              ///< received or created, not yet looked at
  kHostRegion,            ///< far from every boundary: nothing is published
  kIntersectingBoundary,  ///< near another region (Aura::zone): projects its aura
  kBoundaryTraversed,     ///< wholly outside its host's region: projects its aura, goes home as soon as it is an island
  kSent,                  ///< handed over, and out of this host's world
};
inline constexpr int kPhases = 5;

enum class PhaseEvent : std::uint8_t {
  kFarFromBoundary,  ///< no region or foreign body within reach
  kNearBoundary,     ///< within reach of another region or of a foreign body, not wholly outside its own
  kOutside,          ///< wholly outside its own region
  kAuraHit,          ///< AC: its cluster has met an aura of a lower region
  kIsland,           ///< BT: its cluster has been an island for long enough
};
inline constexpr int kPhaseEvents = 5;

/// The phase after `event`, or nothing where the thesis has no such transition.
std::optional<Phase> next_phase(Phase phase, PhaseEvent event);

/// Does a body in this phase project its aura?
constexpr bool projects(Phase phase) {
  return phase == Phase::kIntersectingBoundary || phase == Phase::kBoundaryTraversed;
}

}  // namespace aurasim::core
