// The scene's shapes as Bullet shapes. Bodies and statics share them, and they never change.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/scene.h"

class btCollisionShape;
class btConvexShape;
class btStridingMeshInterface;

namespace aurasim::physics {

/// Bullet's collision margin. Bullet rounds shapes by it, so that it seldom has to handle shapes that really overlap.
enum class Margin {
  kInside,  ///< the surface is that of the scene with rounded edges; for simulating
  kNone,    ///< the exact shape; for measuring
};

std::unique_ptr<btConvexShape> make_convex(const core::ConvexShape& shape, Margin margin);

class ShapeSet {
 public:
  /// Throws std::invalid_argument if a body's prototype has a shape that cannot move, or a mesh or hull is empty.
  explicit ShapeSet(const core::Scene& scene);
  ~ShapeSet();
  /// Adds shapes and prototypes that were appended to the scene. Throws like the constructor, with nothing done.
  void extend(const core::Scene& scene);

  btCollisionShape* shape(std::uint32_t index) const;
  /// kg m^2, about the axes of the body's frame.
  const core::Vec3& inertia(core::PrototypeId prototype) const;

 private:
  struct Built;

  std::vector<Built> shapes_;         ///< by shape of Scene::shapes
  std::vector<core::Vec3> inertias_;  ///< by prototype of Scene::prototypes
};

}  // namespace aurasim::physics
