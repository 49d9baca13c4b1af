// What a scene asks of a body beyond what a file says of a link: a shape, and a mass where none is said.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// The shape of a moving link in its frame B: of the prototype that a scene has for it. Of convex collision shapes; a
/// link that has none has a small ball, which is to touch nothing. Parts of a compound are in the order of its
/// collisions.
core::Shape body_shape(const Link& link);

/// Gives a link of convex shapes a mass, spread evenly over them about this centre in L.
void spread_mass_evenly(double mass_kg, const core::Vec3& p_LB, Link& link);

}  // namespace aurasim::importing
