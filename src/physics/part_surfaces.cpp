#include "physics/part_surfaces.h"

#include <algorithm>
#include <utility>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

namespace aurasim::physics {
namespace {

/// Clamps a combined friction to the bounds that Bullet uses.
btScalar as_bullet_bounds(btScalar friction) { return std::clamp(friction, btScalar(-10), btScalar(10)); }

const PartSurfaces* surfaces_of(const btCollisionObject& object) {
  const btCollisionShape& shape = *object.getCollisionShape();
  return shape.isCompound() ? static_cast<const PartSurfaces*>(shape.getUserPointer()) : nullptr;
}

/// Bullet's callback for every point that it adds or finds again. The last index of each object is that of its part.
bool tell_surface(btManifoldPoint& point, const btCollisionObjectWrapper* a, int /*part_id*/, int part_of_a,
                  const btCollisionObjectWrapper* b, int /*part_id*/, int part_of_b) {
  const Surface both =
      combined(surface_at(*a->getCollisionObject(), part_of_a), surface_at(*b->getCollisionObject(), part_of_b));
  point.m_combinedFriction = both.friction;
  point.m_combinedRollingFriction = both.rolling_friction;
  point.m_combinedSpinningFriction = both.spinning_friction;
  point.m_combinedRestitution = both.restitution;
  return true;  // Bullet ignores the result
}

}  // namespace

Surface surface_of(const core::Material& material) {
  return {static_cast<btScalar>(material.friction), static_cast<btScalar>(material.rolling_friction),
          static_cast<btScalar>(material.spinning_friction), static_cast<btScalar>(material.restitution)};
}

Surface combined(const Surface& a, const Surface& b) {
  return {as_bullet_bounds(a.friction * b.friction),
          as_bullet_bounds(a.rolling_friction * b.friction + b.rolling_friction * a.friction),
          as_bullet_bounds(a.spinning_friction * b.friction + b.spinning_friction * a.friction),
          a.restitution * b.restitution};
}

std::unique_ptr<const PartSurfaces> part_surfaces_of(const core::Compound& compound, const core::Scene& scene) {
  const auto has_own = [](const core::CompoundPart& part) { return part.material.has_value(); };
  if (std::ranges::none_of(compound.parts, has_own)) return nullptr;
  PartSurfaces surfaces;
  for (const core::CompoundPart& part : compound.parts) {
    std::optional<Surface>& surface = surfaces.emplace_back();
    if (part.material) surface = surface_of(scene.materials.at(*part.material));
  }
  return std::make_unique<const PartSurfaces>(std::move(surfaces));
}

void set_part_surfaces(btCompoundShape& shape, const PartSurfaces* surfaces) {
  shape.setUserPointer(const_cast<PartSurfaces*>(surfaces));  // only read, by surfaces_of()
}

void use_part_surfaces(btCollisionObject& object) {
  if (surfaces_of(object) == nullptr) return;
  [[maybe_unused]] static const bool told_bullet = [] {
    gContactAddedCallback = tell_surface;
    return true;
  }();
  object.setCollisionFlags(object.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
}

Surface surface_at(const btCollisionObject& object, int part) {
  const PartSurfaces* const parts = surfaces_of(object);
  if (parts != nullptr && part >= 0 && static_cast<std::size_t>(part) < parts->size()) {
    if (const std::optional<Surface>& own = (*parts)[static_cast<std::size_t>(part)]) return *own;
  }
  return {object.getFriction(), object.getRollingFriction(), object.getSpinningFriction(), object.getRestitution()};
}

}  // namespace aurasim::physics
