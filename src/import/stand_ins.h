// What a scene asks of a body beyond what a file says of a link: a collision shape, with mass spread evenly over it.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// The shape of a moving link in its frame B: of the prototype that a scene has for it. Of convex collision shapes.
core::Shape body_shape(const Link& link);

/// A link that moves and has no collision shape gets the box of its mass and moments, apart from all other links; told
/// of.
void give_stand_ins(Model& model);

/// A scene's body has one surface: that of its first shape. Tells of links that have several.
void give_one_surface(Model& model);

/// A scene's body has the moments of mass spread evenly over its shape. Tells of links that have others.
void compare_inertias(Model& model);

/// Gives a link of convex shapes a mass, spread evenly over them about this centre in L.
void spread_mass_evenly(double mass_kg, const core::Vec3& p_LB, Link& link);

}  // namespace aurasim::importing
