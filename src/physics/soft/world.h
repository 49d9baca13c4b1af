// The world of the soft step: what touches is found once, then islands, then all substeps (step.h). Bullet finds the
// pairs and tells their contacts.
#pragma once

#include "physics/stepper.h"

namespace aurasim::physics {

std::unique_ptr<btDiscreteDynamicsWorld> make_soft_world(const WorldParts& parts, const Settings& settings);

}  // namespace aurasim::physics
