// Surfaces of bodies whose parts have materials of their own, such as a rubber foot of a steel leg. Bullet combines the
// surfaces of two whole bodies. Here a new contact point of such a body gets the surfaces of the two parts.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <LinearMath/btScalar.h>

#include "core/scene.h"

class btCollisionObject;
class btCompoundShape;

namespace aurasim::physics {

/// Surface properties of a material, or of a contact point of two materials.
struct Surface {
  btScalar friction = 0;
  btScalar rolling_friction = 0;   ///< m
  btScalar spinning_friction = 0;  ///< m
  btScalar restitution = 0;
};

Surface surface_of(const core::Material& material);

/// Combines two surfaces as Bullet does (btManifoldResult).
Surface combined(const Surface& a, const Surface& b);

/// By part of a compound; nothing: the part has the surface of the body.
using PartSurfaces = std::vector<std::optional<Surface>>;

/// The surfaces of a compound's parts; null if no part has a material of its own.
std::unique_ptr<const PartSurfaces> part_surfaces_of(const core::Compound& compound, const core::Scene& scene);

/// Attaches part surfaces to a shape; null for none. `surfaces` have to outlive the shape.
void set_part_surfaces(btCompoundShape& shape, const PartSurfaces* surfaces);

/// Makes new contact points of the object use its parts' surfaces.
void use_part_surfaces(btCollisionObject& object);

/// Surface of part `part` of the object's compound. That of the object if it is no compound, or if the part has no
/// surface of its own.
Surface surface_at(const btCollisionObject& object, int part);

}  // namespace aurasim::physics
