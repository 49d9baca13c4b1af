// Converts sdformat's poses and errors to ours. Only for the SDF reader.
#pragma once

#include <sdf/sdf.hh>

#include "import/model.h"

namespace aurasim::importing {

inline core::Vec3 vec3_of(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

inline core::Quat quat_of(const ignition::math::Quaterniond& q) { return {q.W(), q.X(), q.Y(), q.Z()}; }

inline core::Pose pose_of(const ignition::math::Pose3d& pose) {
  return {vec3_of(pose.Pos()), quat_of(pose.Rot()).normalized()};
}

/// Pose of a frame in the frame `to`, by default in its parent. Throws BadModel with `element`.
inline core::Pose resolved(const sdf::SemanticPose& pose, const std::string& to, const std::string& element) {
  ignition::math::Pose3d found;
  const sdf::Errors errors = pose.Resolve(found, to);
  if (!errors.empty()) throw BadModel({element + ": " + errors.front().Message()});
  return pose_of(found);
}

/// Context of a model that is being read: its pose in the world, and the prefix of its names.
struct SdfScope {
  const sdf::Model& model;
  core::Pose X_WM;
  std::string prefix;  ///< "outer::inner::"; empty for a model that is alone in its file
  bool is_static = false;
  std::size_t root = 0;  ///< number of the outermost model
};

}  // namespace aurasim::importing
