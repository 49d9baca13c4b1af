// Bodies and joints for ROS 2: names of frames, and positions of joints. Pure functions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/launch.h"
#include "core/body_state.h"
#include "core/joint_motion.h"
#include "core/scene.h"
#include "dds/ros2_bus.h"

namespace aurasim::process {

/// Simulated time of a state, to the nanosecond.
dds::Ros2Time ros2_time(core::Step step, double step_hz);

/// Names of bodies' frames: the name in the scene's file, or "body_<id>".
class FrameNames {
 public:
  explicit FrameNames(const config::Launch& launch);
  std::string of(core::BodyId id) const;
  /// The body with this name. Nothing if the scene has none.
  std::optional<core::BodyId> body(const std::string& name) const;

 private:
  std::unordered_map<core::BodyId, std::string> names_;
  std::unordered_map<std::string, core::BodyId> ids_;
};

/// The hinges and sliders of a scene.
class JointRows {
 public:
  explicit JointRows(const core::Scene& scene);
  bool empty() const { return rows_.empty(); }
  /// Positions of the joints that hold and whose bodies are both in `snapshot`.
  dds::Ros2Joints in(const core::Snapshot& snapshot) const;

 private:
  struct Row {
    core::JointSpec joint;
    core::JointFrame frame;
    int coordinate;
  };
  std::vector<Row> rows_;
};

}  // namespace aurasim::process
