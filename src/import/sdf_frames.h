// sdformat's poses as ours, and its errors as ours. For the SDF reader alone.
#pragma once

#include <sdf/sdf.hh>

#include "import/model.h"

namespace aurasim::importing {

inline core::Vec3 vec3_of(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

inline core::Quat quat_of(const ignition::math::Quaterniond& q) { return {q.W(), q.X(), q.Y(), q.Z()}; }

inline core::Pose pose_of(const ignition::math::Pose3d& pose) {
  return {vec3_of(pose.Pos()), quat_of(pose.Rot()).normalized()};
}

/// Of a frame as seen from another one, by default its parent. Throws BadModel with `element`.
inline core::Pose resolved(const sdf::SemanticPose& pose, const std::string& to, const std::string& element) {
  ignition::math::Pose3d found;
  const sdf::Errors errors = pose.Resolve(found, to);
  if (!errors.empty()) throw BadModel({element + ": " + errors.front().Message()});
  return pose_of(found);
}

/// A model while it is read: where it stands in the world, and how its names begin.
struct SdfScope {
  const sdf::Model& model;
  core::Pose X_WM;
  std::string prefix;  ///< "outer::inner::"; empty for a model that is alone in its file
  bool is_static = false;
  std::size_t root = 0;  ///< number of the outermost model
};

}  // namespace aurasim::importing
