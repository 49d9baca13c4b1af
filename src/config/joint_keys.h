// The tables of keys of joints, kind by kind.
#pragma once

#include <numbers>

#include "config/keys_of.h"
#include "core/joint.h"

namespace aurasim::config {

/// One degree in radians.
inline constexpr double kDegree = std::numbers::pi / 180;

const KeysOf<core::JointSpec>& keys_of_joint();
const KeysOf<core::JointMotor>& motor_keys();
const KeysOf<core::BallJoint>& keys_of_ball();
/// Keys of a hinge or slider along its free axis, without limits, and of its drive.
const KeysOf<core::HingeJoint>& keys_of_hinge();
const KeysOf<core::SliderJoint>& keys_of_slider();
const KeysOf<core::JointDrive>& turning_drive_keys();
const KeysOf<core::JointDrive>& sliding_drive_keys();
/// Keys of the coupling to a joint that a hinge or slider follows, except that joint's name.
const KeysOf<core::JointCoupling>& keys_of_coupling();
/// Keys of an axis along which a spring joint moves, and of one about which it turns.
const KeysOf<core::SpringAxis>& sliding_axis_keys();
const KeysOf<core::SpringAxis>& turning_axis_keys();

}  // namespace aurasim::config
