// Questions of core/ to physics/ about prototypes: distances between shapes, and sizes.
#pragma once

#include <limits>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// Distance between the real shapes of two bodies. Implemented by physics/ (Bullet's GJK).
class ClearanceQuery {
 public:
  virtual ~ClearanceQuery() = default;

  /// Metres between the surfaces, negative when they overlap; anything above `limit_m` may be answered with any value
  /// above `limit_m`. Shapes have their stated size: Bullet's collision margin does not count.
  virtual double clearance(PrototypeId a, const Pose& pose_a, PrototypeId b, const Pose& pose_b,
                           double limit_m) const = 0;

  /// Radius of the sphere around the body's origin that holds its shape. Metres.
  virtual double bounding_radius(PrototypeId prototype) const = 0;
};

/// Every body is a point and infinitely far from all others. For the reaches of auras that do not depend on shapes.
class NoShapes final : public ClearanceQuery {
 public:
  double clearance(PrototypeId, const Pose&, PrototypeId, const Pose&, double) const override {
    return std::numeric_limits<double>::infinity();
  }
  double bounding_radius(PrototypeId) const override { return 0; }
};

}  // namespace aurasim::core
