// What is possible in a scene, and nearly always a mistake.
#pragma once

#include <string>
#include <vector>

#include "config/launch.h"

namespace aurasim::cli {

/// Bodies that overlap each other, a convex static or the ground at the start, or lie below it; bodies and injectors
/// that are faster than tolerances.speed. Each names its bodies, and the place in the scene file. At most 10 of a kind
/// one by one.
std::vector<std::string> scene_warnings(const config::Launch& launch);

}  // namespace aurasim::cli
