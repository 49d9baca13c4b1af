// What core/ asks of physics/ about a body's kind.
#pragma once

#include <limits>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::core {

/// What decides how much of a push a body passes on.
struct BodyTraits {
  double mass_kg = 1;
  double restitution = 1;  ///< of its material, 0 to 1
};

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

  /// A body of which nothing is known passes on all that it gets.
  virtual BodyTraits traits(PrototypeId) const { return {}; }
};

/// Where every body is a point: reaches do not ask for shapes.
class NoShapes final : public ClearanceQuery {
 public:
  double clearance(PrototypeId, const Pose&, PrototypeId, const Pose&, double) const override {
    return std::numeric_limits<double>::infinity();
  }
  double bounding_radius(PrototypeId) const override { return 0; }
};

}  // namespace aurasim::core
