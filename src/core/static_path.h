// Statics that move as their scene says: lifts, gates, turntables. Where they are follows from the time alone, so every
// node knows it, and nothing is told.
#pragma once

#include "core/body_state.h"
#include "core/scene.h"

namespace aurasim::core {

/// In the time t_s >= 0. The same bits on every machine: it is computed by what IEEE 754 rounds.
Pose pose_at(const StaticBody& body, double t_s);

/// On the straight way and the shorter turn from one to the other, by a share from 0 to 1. Likewise the same bits.
Pose pose_between(const Pose& from, const Pose& to, double share);

/// Of one that goes from `before` to `after` in `duration_s`, evenly: m/s of its origin and rad/s, in the world.
struct Twist {
  Vec3 v_W = Vec3::Zero();
  Vec3 w_W = Vec3::Zero();
};
Twist twist_between(const Pose& before, const Pose& after, double duration_s);

}  // namespace aurasim::core
