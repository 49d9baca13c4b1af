// A static of a scene: contacts never move it, and it is the same on every node.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/body_state.h"

namespace aurasim::core {

/// Pose of a static at a time, X_SP, relative to its pose S at the start.
struct PathStop {
  double at_s = 0;
  Pose X_SP;
};

/// The path of a static: from its pose in state 0 straight from stop to stop, with the shorter turn.
struct StaticPath {
  std::vector<PathStop> stops;  ///< at least one; ascending at_s > 0
  /// true: starts again after the last stop, which has to be the start; false: stays at the last stop
  bool repeats = false;
  /// true: rests at each stop, and its speed has no jumps; false: constant speed between two stops
  bool smooth = true;
};

/// Its StaticId is the index in Scene::statics.
struct StaticBody {
  std::string name;
  std::uint32_t shape = 0;
  std::uint32_t material = 0;
  Pose pose;  ///< pose at the start
  std::optional<StaticPath> path = {};
  Vec3 belt_S = Vec3::Zero();  ///< velocity of its surface along itself, as of a conveyor, m/s in the axes of S

  bool moves() const { return path.has_value() || !belt_S.isZero(); }
};

}  // namespace aurasim::core
