// The tables of keys of joints, kind by kind.
#pragma once

#include <numbers>

#include "config/keys_of.h"
#include "core/joint.h"

namespace aurasim::config {

/// In radians.
inline constexpr double kDegree = std::numbers::pi / 180;

const KeysOf<core::JointSpec>& keys_of_joint();
const KeysOf<core::JointMotor>& motor_keys();
const KeysOf<core::BallJoint>& keys_of_ball();
/// What a hinge or slider has along the axis that it leaves, without limits, and what drives it.
const KeysOf<core::HingeJoint>& keys_of_hinge();
const KeysOf<core::SliderJoint>& keys_of_slider();
const KeysOf<core::JointDrive>& turning_drive_keys();
const KeysOf<core::JointDrive>& sliding_drive_keys();
/// Of what a hinge or slider follows, but for its name.
const KeysOf<core::JointCoupling>& keys_of_coupling();
/// Of an axis along which a spring lets move, and of one about which it lets turn.
const KeysOf<core::SpringAxis>& sliding_axis_keys();
const KeysOf<core::SpringAxis>& turning_axis_keys();

}  // namespace aurasim::config
