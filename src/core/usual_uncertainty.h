// U (docs/design.md, "Swept auras") where nobody has chosen it.
#pragma once

#include "core/sync_mode.h"

namespace aurasim::core {

/// Share of its speed by which a body may leave its path, in runs whose nodes wait for each other. A smaller one leads
/// to more redos, which cost more than what it saves (docs/decisions/0033-no-pushes.md).
inline constexpr double kUncertainty = 0.5;
/// The same share in free-running runs. Messages come later than promised there, and a larger share has made fewer
/// collisions late.
inline constexpr double kUncertaintyFreeRunning = 1.5;

constexpr double usual_uncertainty(SyncMode sync) {
  return sync == SyncMode::kFreeRunning ? kUncertaintyFreeRunning : kUncertainty;
}

}  // namespace aurasim::core
