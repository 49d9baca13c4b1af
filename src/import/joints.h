// Converts joints of one or several axes to those of a scene.
#pragma once

#include <limits>

#include "import/model.h"

namespace aurasim::importing {

/// One axis of a joint, along which it slides or about which it turns, as files describe it. Infinite limits mean no
/// limits.
struct AxisRule {
  core::Vec3 axis_W = core::Vec3::UnitZ();
  bool turns = true;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  core::JointResistance resistance = {};
  std::optional<core::JointDrive> drive = {};
};

/// Rotation that takes z to the axis, equal to the one that the scene reader makes of a hinge's or slider's `axis`.
core::Quat axis_frame(const core::Vec3& axis_W);

/// Returns a joint with one axis along z of J: a hinge or slider.
core::JointKind one_axis_kind(const AxisRule& rule);

struct SeveralAxes {
  core::JointKind kind;
  core::Quat q_WJ;
};

/// Returns a joint of several axes, each moved by those before it: first sliding axes, then turning ones, each kind
/// perpendicular among itself. Nothing if they are not, or if a turn in the middle may reach a quarter, where its
/// neighbours' axes would coincide.
std::optional<SeveralAxes> several_axes_kind(const std::vector<AxisRule>& rules, const std::string& element,
                                             Model& model);

}  // namespace aurasim::importing
