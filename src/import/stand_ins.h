// Supplies what a scene requires of a body and a file may lack: a shape and a mass.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Shape of a moving link in its frame B, for its prototype in the scene. Made of convex collision shapes. A link
/// without any gets a small ball that touches nothing. Parts of a compound are in the order of the link's collisions.
core::Shape body_shape(const Link& link);

/// Gives a link of convex shapes a mass, spread evenly over them, with the centre of mass `p_LB` in L.
void spread_mass_evenly(double mass_kg, const core::Vec3& p_LB, Link& link);

}  // namespace aurasim::importing
