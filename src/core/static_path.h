// Statics that move along a path of their scene: lifts, gates, turntables. Their poses follow from the time alone, so
// no messages are needed.
#pragma once

#include "core/body_state.h"
#include "core/scene.h"

namespace aurasim::core {

/// Pose of the static at time t_s >= 0. The same bits on every machine: uses only operations that IEEE 754 defines
/// exactly.
Pose pose_at(const StaticBody& body, double t_s);

/// Pose on the straight way and the shorter turn between two poses, at `share` from 0 to 1. The same bits on every
/// machine.
Pose pose_between(const Pose& from, const Pose& to, double share);

/// Velocity of the origin (m/s) and spin (rad/s) in the world, of a static that goes evenly from `before` to `after` in
/// `duration_s`.
struct Twist {
  Vec3 v_W = Vec3::Zero();
  Vec3 w_W = Vec3::Zero();
};
Twist twist_between(const Pose& before, const Pose& after, double duration_s);

}  // namespace aurasim::core
