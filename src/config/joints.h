// Joints of a scene.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostJoints = 1'000'000;

/// Keys of a joint: exactly one kind of joint, and the keys that all kinds have.
const KeyTable& joint_keys();

/// Reads the joints. Call it after all bodies have been read.
void read_joints(const Field& field, SceneDraft& draft);

/// Sets the joints' ids and those of their bodies. Call it once the bodies have their ids.
void number_joints(SceneDraft& draft);

}  // namespace aurasim::config
