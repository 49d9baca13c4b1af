// What a launch file cannot say: what clients ask for in mid-run, and ranks that change.
#pragma once

#include "lab/pair.h"
#include "lab/scenes/json.h"
#include "lab/scenes/random_kinds.h"
#include "lab/scenes/random_layout.h"

namespace aurasim::lab {

/// The first state that an order of a random world may name, and the last: early enough for a run of 400 steps.
inline constexpr std::int64_t kFirstOrder = 50, kLastOrder = 360;

/// interference.json (see interference.h) for a scene that has its bodies. `speed_m_s`: that clients may ask for.
Json random_interference(const Kinds& kinds, const RandomLayout& layout, const Json& scene, double speed_m_s,
                         Chance& chance);

}  // namespace aurasim::lab
