// Whether a saved world fits a scene: everything that its bodies and orders name has to be there.
#pragma once

#include "core/scene.h"
#include "core/world_cut.h"

namespace aurasim::node {

/// Checks the setpoints and orders of a saved world. `scene`: without what the orders add. Throws std::invalid_argument
/// that names what does not fit.
void check_orders(const core::WorldCut& world, const core::Scene& scene);
/// Checks the bodies of a saved world, also those under way. `scene`: with all that the orders add. Throws
/// std::invalid_argument that names what does not fit.
void check_bodies(const core::WorldCut& world, const core::Scene& scene);

}  // namespace aurasim::node
