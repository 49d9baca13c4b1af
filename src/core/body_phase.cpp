#include "core/body_phase.h"

#include <array>

namespace aurasim::core {
namespace {

using P = Phase;
using Row = std::array<std::optional<Phase>, kPhaseEvents>;
constexpr std::nullopt_t no = std::nullopt;

// clang-format off
// event:                        kFarFromBoundary  kNearBoundary             kOutside               kAuraHit  kIsland
constexpr std::array<Row, kPhases> kTable = {{
/* kInjected             */ Row{P::kHostRegion,    P::kIntersectingBoundary, P::kBoundaryTraversed, no,       no},
/* kHostRegion           */ Row{P::kHostRegion,    P::kIntersectingBoundary, P::kBoundaryTraversed, P::kSent, no},
/* kIntersectingBoundary */ Row{P::kHostRegion,    P::kIntersectingBoundary, P::kBoundaryTraversed, P::kSent, no},
/* kBoundaryTraversed    */ Row{P::kHostRegion,    P::kIntersectingBoundary, P::kBoundaryTraversed, P::kSent, P::kSent},
/* kSent                 */ Row{no,                no,                       no,                    no,       no},
}};
// clang-format on

}  // namespace

std::optional<Phase> next_phase(Phase phase, PhaseEvent event) {
  return kTable[static_cast<std::size_t>(phase)][static_cast<std::size_t>(event)];
}

}  // namespace aurasim::core
