// Joints of one axis, and of several, as those of a scene.
#pragma once

#include <limits>

#include "import/model.h"

namespace aurasim::importing {

/// One way or turn of a joint, as files describe it. Infinite limits are none.
struct AxisRule {
  core::Vec3 axis_W = core::Vec3::UnitZ();
  bool turns = true;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  core::JointResistance resistance = {};
  std::optional<core::JointDrive> drive = {};
};

/// The rotation that takes z to the axis: as the scene reader makes it of a hinge's or slider's `axis`.
core::Quat axis_frame(const core::Vec3& axis_W);

/// Of one axis along z of J: a hinge or slider.
core::JointKind one_axis_kind(const AxisRule& rule);

struct SeveralAxes {
  core::JointKind kind;
  core::Quat q_WJ;
};

/// Of several axes, each moved by those before it: ways first, then turns, each kind square to its own. Nothing if they
/// are not, or if a turn in the middle may be as far as a quarter, where its neighbours' axes would meet.
std::optional<SeveralAxes> several_axes_kind(const std::vector<AxisRule>& rules, const std::string& element,
                                             Model& model);

}  // namespace aurasim::importing
