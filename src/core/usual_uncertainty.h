// U (docs/design.md, "Swept auras") where nobody has chosen it.
#pragma once

#include "core/sync_mode.h"

namespace aurasim::core {

/// Share of its speed by which a body may leave its path, at lookahead K. Where nodes wait for each other, a smaller
/// one leads to more redos, and a larger one to larger clusters: from K = 4 on their links reach so far that they cost
/// more (docs/decisions/0042-gathered-in-the-cut.md). In free-running runs messages come later than promised, and a
/// larger share has made fewer collisions late.
constexpr double usual_uncertainty(SyncMode sync, int lookahead) {
  return sync == SyncMode::kFreeRunning ? 1.5 : lookahead < 4 ? 0.5 : 1.2 / lookahead;
}

}  // namespace aurasim::core
