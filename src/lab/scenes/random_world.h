// Makes a random world from a seed: scene, launch and interference that stress the protocol. The same seed gives the
// same world on every machine.
#pragma once

#include <cstdint>

#include "lab/scenes/world_files.h"

namespace aurasim::lab {

/// The launch file names this program's precision. The seed determines everything else.
World random_world(std::uint64_t seed);

}  // namespace aurasim::lab
