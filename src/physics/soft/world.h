// The world of the soft step: contacts are found once, then islands, then all substeps are computed (step.h). Bullet
// finds the pairs and computes their contacts.
#pragma once

#include "physics/stepper.h"

namespace aurasim::physics {

std::unique_ptr<World> make_soft_world(const WorldParts& parts, const Settings& settings);

}  // namespace aurasim::physics
