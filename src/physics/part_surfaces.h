// Surfaces of bodies of which parts have materials of their own: a rubber foot of a steel leg. Bullet combines those of
// two whole bodies; where a new point touches such a body, it is told what the two parts have.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <LinearMath/btScalar.h>

#include "core/scene.h"

class btCollisionObject;
class btCompoundShape;

namespace aurasim::physics {

/// Of a material, or of a point at which two of them touch.
struct Surface {
  btScalar friction = 0;
  btScalar rolling_friction = 0;   ///< m
  btScalar spinning_friction = 0;  ///< m
  btScalar restitution = 0;
};

Surface surface_of(const core::Material& material);

/// As Bullet combines those of two whole bodies (btManifoldResult).
Surface combined(const Surface& a, const Surface& b);

/// By part of a compound; nothing: the body's.
using PartSurfaces = std::vector<std::optional<Surface>>;

/// Null: no part has a material of its own.
std::unique_ptr<const PartSurfaces> part_surfaces_of(const core::Compound& compound, const core::Scene& scene);

/// `surfaces` outlive the shape. Null: it has none.
void set_part_surfaces(btCompoundShape& shape, const PartSurfaces* surfaces);

/// For objects of which parts have surfaces of their own: its new points of contact have them from now on.
void use_part_surfaces(btCollisionObject& object);

/// `part`: of its compound; if it has none, or the part none of its own, the object's.
Surface surface_at(const btCollisionObject& object, int part);

}  // namespace aurasim::physics
