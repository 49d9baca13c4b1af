// The one geometric question that core/ asks of physics/.
#pragma once

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// Distance between the real shapes of two bodies. Given to core/ by physics/ (Bullet's GJK).
class ClearanceQuery {
 public:
  virtual ~ClearanceQuery() = default;

  /// Metres between the surfaces, negative when they overlap; anything above `limit_m` may be answered with
  /// any value above `limit_m`. Shapes without Bullet's collision margin grown on top of their stated size.
  virtual double clearance(PrototypeId a, const Pose& pose_a, PrototypeId b, const Pose& pose_b,
                           double limit_m) const = 0;

  /// Radius of the sphere around the body's origin that holds its shape. Metres.
  virtual double bounding_radius(PrototypeId prototype) const = 0;
};

}  // namespace aurasim::core
