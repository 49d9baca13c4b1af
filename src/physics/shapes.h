// The scene's shapes as Bullet's. Bodies and statics share them; they never change.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/scene.h"

class btCollisionShape;
class btConvexShape;
class btStridingMeshInterface;

namespace aurasim::physics {

/// Bullet rounds shapes by a margin, so that it seldom has to deal with shapes that really overlap.
enum class Margin {
  kInside,  ///< the surface stays where the scene says, edges are rounded; for simulating
  kNone,    ///< the shape as it is; for measuring
};

std::unique_ptr<btConvexShape> make_convex(const core::ConvexShape& shape, Margin margin);

class ShapeSet {
 public:
  /// Throws std::invalid_argument if a body's prototype has a shape that cannot move, or a mesh or hull is empty.
  explicit ShapeSet(const core::Scene& scene);
  ~ShapeSet();
  /// What the scene has got since. As the constructor; with nothing done if it throws.
  void extend(const core::Scene& scene);

  btCollisionShape* shape(std::uint32_t index) const;
  /// kg m^2, about the axes of the body's frame.
  const core::Vec3& inertia(core::PrototypeId prototype) const;

 private:
  struct Built;

  std::vector<Built> shapes_;         ///< as Scene::shapes
  std::vector<core::Vec3> inertias_;  ///< as Scene::prototypes
};

}  // namespace aurasim::physics
