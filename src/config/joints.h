// Joints of a scene.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostJoints = 1'000'000;

/// Exactly one kind of joint, and what all of them take.
const KeyTable& joint_keys();

/// After all bodies.
void read_joints(const Field& field, SceneDraft& draft);

/// Once the bodies have their ids.
void number_joints(SceneDraft& draft);

}  // namespace aurasim::config
