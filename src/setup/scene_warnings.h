// Warns of things in a scene that are allowed but nearly always a mistake.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/launch.h"

namespace aurasim::setup {

/// Bodies that overlap another one, a convex static or the ground at the start, or lie below it; bodies and injectors
/// that are faster than tolerances.speed. Each warning names its bodies and the place in the scene file. At most 10
/// warnings of a kind are listed, then their count. Takes time n log n if few bodies are near each other without an
/// overlap. `reached` is called with the share of the work that is done, 0 to 1.
std::vector<std::string> scene_warnings(const config::Launch& launch,
                                        const std::function<void(double)>& reached = nullptr);

}  // namespace aurasim::setup
