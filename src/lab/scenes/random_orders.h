// Random events that a launch file cannot contain: clients' requests in mid-run.
#pragma once

#include "lab/pair.h"
#include "lab/scenes/json.h"
#include "lab/scenes/random_kinds.h"
#include "lab/scenes/random_layout.h"

namespace aurasim::lab {

/// The first and the last state that an order of a random world may name. They fit a run of 400 steps.
inline constexpr std::int64_t kFirstOrder = 50, kLastOrder = 360;

/// Contents of interference.json (interference.h). Precondition: `scene` has its bodies. `speed_m_s`: highest speed
/// that clients ask for.
Json random_interference(const Kinds& kinds, const RandomLayout& layout, const Json& scene, double speed_m_s,
                         Chance& chance);

}  // namespace aurasim::lab
