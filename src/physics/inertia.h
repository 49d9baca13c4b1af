// Inertia of solid bodies of even density. Bullet's own functions use the bounding box of a capsule, cylinder, hull or
// compound, so that a long cylinder turns up to 1.3 times too slowly.
#pragma once

#include "core/scene.h"

namespace aurasim::physics {

/// Diagonal of the inertia tensor about the origin of the shape's frame, kg m^2. The origin is taken for the centre
/// of mass; products of inertia, which Bullet cannot hold, are left out. A shape without volume (flat hull) turns
/// like the sphere around it. Throws std::invalid_argument for planes and triangle meshes.
core::Vec3 inertia_diagonal(const core::Shape& shape, double mass_kg);

/// Moments of inertia of a prototype, kg m^2: Prototype::inertia, or else those of mass spread evenly over its shape.
core::Vec3 inertia_of(const core::Prototype& prototype, const core::Scene& scene);

}  // namespace aurasim::physics
