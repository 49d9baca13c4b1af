// The tables of keys of joints, kind by kind.
#pragma once

#include "config/keys_of.h"
#include "core/joint.h"

namespace aurasim::config {

const KeysOf<core::JointSpec>& keys_of_joint();
const KeysOf<core::JointMotor>& motor_keys();
/// Of an axis along which a spring lets move, and of one about which it lets turn.
const KeysOf<core::SpringAxis>& sliding_axis_keys();
const KeysOf<core::SpringAxis>& turning_axis_keys();

}  // namespace aurasim::config
