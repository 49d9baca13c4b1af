// Bodies and joints as ROS 2 sees them: names of frames, and where a joint stands. Pure.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/launch.h"
#include "core/body_state.h"
#include "core/scene.h"
#include "dds/ros2_bus.h"

namespace aurasim::cli {

/// Simulated time of a state, to the nanosecond.
dds::Ros2Time ros2_time(core::Step step, double step_hz);

/// What the scene's file calls a body, or "body_<id>".
class FrameNames {
 public:
  explicit FrameNames(const config::Launch& launch);
  std::string of(core::BodyId id) const;
  /// Nothing: no body of the scene has this name.
  std::optional<core::BodyId> body(const std::string& name) const;

 private:
  std::unordered_map<core::BodyId, std::string> names_;
  std::unordered_map<std::string, core::BodyId> ids_;
};

/// A turn of a hinge, rad and rad/s, or the way of a slider, m and m/s, from the initial poses on. Of a relative to b,
/// about or along the z axis of J.
struct JointMotion {
  double position = 0;
  double velocity = 0;
};

/// Nothing: a joint of another kind. `b` null: the world. `X_AJ`, `X_BJ`: where J is in either body.
std::optional<JointMotion> motion_of(const core::JointKind& kind, const core::Pose& X_AJ, const core::BodyState& a,
                                     const core::Pose& X_BJ, const core::BodyState* b);

/// The hinges and sliders of a scene.
class JointRows {
 public:
  explicit JointRows(const core::Scene& scene);
  bool empty() const { return rows_.empty(); }
  /// Of those whose bodies are both in `snapshot`, and hold together there.
  dds::Ros2Joints in(const core::Snapshot& snapshot) const;

 private:
  struct Row {
    core::JointSpec joint;
    core::Pose X_AJ, X_BJ;
  };
  std::vector<Row> rows_;
};

}  // namespace aurasim::cli
