// Between Eigen, which the rest of the program speaks, and Bullet. In the single precision build numbers are rounded
// on the way in; the way out is exact.
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

/// Between the world frame and Bullet's, whose axes are parallel and whose origin is elsewhere (Settings::p_WO).
class LocalFrame {
 public:
  explicit LocalFrame(const core::Vec3& p_WO) : p_WO_(p_WO), p_OW_(core::Vec3::Zero() - p_WO) {}

  btVector3 to_local(const core::Vec3& p_W) const { return to_bullet(core::Vec3(p_W - p_WO_)); }
  btTransform to_local(const core::Pose& X_W) const {
    return to_bullet(core::Pose{core::Vec3(X_W.p_WB - p_WO_), X_W.q_WB});
  }
  core::Vec3 to_world(const btVector3& p_O) const { return from_bullet(p_O) - p_OW_; }

 private:
  core::Vec3 p_WO_;
  core::Vec3 p_OW_;  ///< subtracted, and never -0: so -0 stays -0 where the origins are the same
};

inline core::Mat3 from_bullet(const btMatrix3x3& m) {
  core::Mat3 result;
  for (int row = 0; row < 3; ++row) result.row(row) = from_bullet(m[row]).transpose();
  return result;
}

}  // namespace aurasim::physics
