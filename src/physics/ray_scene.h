// A scene to cast rays at, for observers: its statics, and bodies wherever they are said to be. What a ray meets hangs
// on these alone, not on who hosts whom.
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

/// Rays from one point.
struct RayFan {
  core::Pose X_WS;                         ///< of the sensor's frame S
  std::span<const core::Vec3> directions;  ///< in S, of length 1
  double range_m = 0;
  std::optional<core::BodyId> carrier;  ///< which its rays go through
};

struct PlacedBody {
  core::BodyId id{};
  core::PrototypeId prototype{};
  core::Pose pose;
};

class RayScene {
 public:
  /// The scene outlives it, and may grow; its states are step_s apart. Throws std::invalid_argument for shapes that
  /// Bullet cannot use.
  RayScene(const core::Scene& scene, double step_s);
  ~RayScene();

  /// An order about a static, or one that has defined a shape, prototype or static in the scene before. Throws
  /// likewise.
  void add(const core::Order& order);

  /// The nearest body or static on each way, in state `step`. Of two at the same distance the one with the lower
  /// reference. `bodies`: all that are within the range; those of unknown prototypes are left out.
  std::vector<RayHit> cast(core::Step step, std::span<const PlacedBody> bodies, const RayFan& fan) const;

  /// Of the largest body that it knows, m.
  double largest_radius_m() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::physics
