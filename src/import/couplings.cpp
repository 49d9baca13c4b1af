#include "import/couplings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/joint_ways.h"

namespace aurasim::importing {
namespace {

/// Frequency of a follower's drive, with everything that may hang from it: higher than the motion of its leader, lower
/// than a step allows.
constexpr double kStiffness_rad_s = 2 * std::numbers::pi * 30;
/// Largest stiffness and damping that a scene accepts.
constexpr double kMostGain = 1e9;

bool has_own_axis(const core::JointKind& kind) {
  return std::holds_alternative<core::HingeJoint>(kind) || std::holds_alternative<core::SliderJoint>(kind);
}

bool hang_together(std::size_t follower, std::size_t leader, const Model& model) {
  std::vector<core::JointEnds> ends;
  for (const Joint& joint : model.joints) {
    ends.push_back({joint.child, joint.parent ? std::optional<std::uint64_t>(*joint.parent) : std::nullopt});
  }
  const auto id = [](std::size_t place) { return core::JointId{static_cast<std::uint32_t>(place)}; };
  return !core::JointWays(std::move(ends)).way(id(follower), id(leader)).empty();
}

/// Upper bound of the inertia that the joint moves: mass, kg, or moment about the joint, kg m^2.
double most_inertia(const Joint& joint, const Model& model) {
  double inertia = 0;
  for (const Link& link : model.links) {
    if (link.is_static) continue;
    const core::Vec3 arm = link.X_WL.p_WB + link.X_WL.q_WB * link.p_LB - joint.X_WJ.p_WB;
    const bool turns = std::holds_alternative<core::HingeJoint>(joint.kind);
    inertia += turns ? link.mass_kg * arm.squaredNorm() + link.I_BL.trace() : link.mass_kg;
  }
  return inertia;
}

double bound_of(const core::JointKind& kind) { return core::drive_of(kind).value_or(core::JointDrive{}).max_effort; }

}  // namespace

std::string follow(std::size_t follower, std::size_t leader, double ratio, double offset, Model& model) {
  Joint& joint = model.joints.at(follower);
  const core::JointKind& lead = model.joints.at(leader).kind;
  if (!has_own_axis(joint.kind) || !has_own_axis(lead)) return "of several axes, or none";
  if (!hang_together(follower, leader, model)) return "only by the world do they hang together";
  const core::JointDrive own = core::drive_of(joint.kind).value_or(core::JointDrive{});
  if (own != core::JointDrive{.max_effort = own.max_effort}) return "it is driven itself";
  core::JointDrive drive{.position = offset, .max_effort = own.max_effort};
  if (std::isinf(drive.max_effort) && ratio != 0) drive.max_effort = bound_of(lead) / std::abs(ratio);
  const double inertia = most_inertia(joint, model);
  drive.stiffness = std::min(kMostGain, inertia * kStiffness_rad_s * kStiffness_rad_s);
  drive.damping = std::min(kMostGain, 2 * inertia * kStiffness_rad_s);
  if (auto* hinge = std::get_if<core::HingeJoint>(&joint.kind)) hinge->drive = drive;
  if (auto* slider = std::get_if<core::SliderJoint>(&joint.kind)) slider->drive = drive;
  core::couple(joint.kind, {core::JointId{static_cast<std::uint32_t>(leader)}, ratio});
  return {};
}

std::optional<std::size_t> find_joint(const Model& model, std::string_view name) {
  const auto found = std::ranges::find(model.joints, name, &Joint::name);
  if (found == model.joints.end()) return std::nullopt;
  return static_cast<std::size_t>(found - model.joints.begin());
}

}  // namespace aurasim::importing
