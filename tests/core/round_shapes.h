// Shapes whose clearance has a closed form, so that core/ can be tested without an engine.
#pragma once

#include <algorithm>
#include <vector>

#include "core/clearance.h"

namespace aurasim::core::testing {

class RoundShapes : public ClearanceQuery {
 public:
  PrototypeId sphere(double radius_m) { return add({{Vec3::Zero()}, radius_m}); }
  /// Two balls, `half_length_m` from the body's origin along x: its spin can be felt.
  PrototypeId dumbbell(double radius_m, double half_length_m) {
    return add({{half_length_m * Vec3::UnitX(), -half_length_m * Vec3::UnitX()}, radius_m});
  }

  double clearance(PrototypeId a, const Pose& pose_a, PrototypeId b, const Pose& pose_b, double) const override {
    const Balls& balls_a = shapes_.at(value_of(a));
    const Balls& balls_b = shapes_.at(value_of(b));
    double nearest = 1e300;
    for (const Vec3& p : balls_a.centres) {
      for (const Vec3& q : balls_b.centres) {
        nearest = std::min(nearest, (pose_a.p_WB + pose_a.q_WB * p - pose_b.p_WB - pose_b.q_WB * q).norm());
      }
    }
    return nearest - balls_a.radius_m - balls_b.radius_m;
  }

  double bounding_radius(PrototypeId prototype) const override {
    const Balls& balls = shapes_.at(value_of(prototype));
    return balls.centres.front().norm() + balls.radius_m;
  }

 private:
  struct Balls {
    std::vector<Vec3> centres;
    double radius_m;
  };

  PrototypeId add(Balls balls) {
    shapes_.push_back(std::move(balls));
    return PrototypeId{static_cast<std::uint32_t>(shapes_.size() - 1)};
  }

  std::vector<Balls> shapes_;
};

}  // namespace aurasim::core::testing
