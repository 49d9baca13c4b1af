// A scene for ray casts by observers: its statics, and bodies at given poses. Hits depend on these alone, not on which
// node hosts a body.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/order.h"
#include "core/scene.h"
#include "physics/results.h"

namespace aurasim::physics {

/// Rays of a sensor, all from one point.
struct RayFan {
  core::Pose X_WS;                         ///< pose of the sensor's frame S
  std::span<const core::Vec3> directions;  ///< unit vectors in S
  double range_m = 0;
  std::optional<core::BodyId> carrier;  ///< the body that carries the sensor; its rays pass through it
};

struct PlacedBody {
  core::BodyId id{};
  core::PrototypeId prototype{};
  core::Pose pose;
};

class RayScene {
 public:
  /// The scene has to outlive the RayScene and may grow. States are step_s apart. Throws std::invalid_argument for
  /// shapes that Bullet cannot use.
  RayScene(const core::Scene& scene, double step_s);
  ~RayScene();

  /// Applies an order about a static, or one that has appended a shape, prototype or static to the scene. Throws
  /// std::invalid_argument for shapes that Bullet cannot use.
  void add(const core::Order& order);

  /// The nearest hit of each ray of `fan` in state `step`. Of two objects at the same distance the one with the lower
  /// ObjectRef. `bodies` has to hold all bodies within the range; those of unknown prototypes are ignored.
  std::vector<RayHit> cast(core::Step step, std::span<const PlacedBody> bodies, const RayFan& fan) const;

  /// Bounding radius of the largest prototype known, m.
  double largest_radius_m() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
