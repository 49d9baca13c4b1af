// Conversions between Eigen, which the rest of the program uses, and Bullet.
#pragma once

#include <LinearMath/btTransform.h>

#include "core/body_state.h"

namespace aurasim::physics {

inline btScalar scalar(double x) { return static_cast<btScalar>(x); }

inline btVector3 to_bullet(const core::Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

inline btMatrix3x3 to_bullet(const core::Mat3& m) {
  const auto at = [&m](int row, int column) { return static_cast<btScalar>(m(row, column)); };
  return {at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2), at(2, 0), at(2, 1), at(2, 2)};
}

inline btTransform to_bullet(const core::Pose& pose) {
  return btTransform(to_bullet(core::Mat3(pose.q_WB.normalized().toRotationMatrix())), to_bullet(pose.p_WB));
}

inline core::Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline core::Mat3 from_bullet(const btMatrix3x3& m) {
  core::Mat3 result;
  for (int row = 0; row < 3; ++row) result.row(row) = from_bullet(m[row]).transpose();
  return result;
}

}  // namespace aurasim::physics
