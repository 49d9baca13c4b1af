// A world from a seed: scene, launch and interference that hurt. The same seed gives the same world everywhere.
#pragma once

#include <cstdint>

#include "lab/scenes/world_files.h"

namespace aurasim::lab {

/// In this program's precision, which the launch file names; of all else the seed decides.
World random_world(std::uint64_t seed);

}  // namespace aurasim::lab
