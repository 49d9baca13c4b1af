#include "import/sdf_joints.h"

#include <cmath>

#include <fmt/format.h>

#include "import/joints.h"

namespace aurasim::importing {
namespace {

constexpr double kNoLimit = 1e15;  ///< sdformat's own is 1e16
constexpr double kNoBound = 1e300;

/// Returns the link at an end of a joint; nothing for "world".
std::optional<std::size_t> end_of(const std::string& name, const SdfScope& scope,
                                  const std::map<std::string, std::size_t>& links, const std::string& element) {
  if (name == "world") return std::nullopt;
  const auto found = links.find(scope.prefix + name);
  if (found == links.end()) throw BadModel({fmt::format("{}: there is no link '{}'", element, scope.prefix + name)});
  return found->second;
}

AxisRule rule_of(const sdf::JointAxis& axis, bool turns, bool limited, const SdfScope& scope,
                 const std::string& element, Model& model) {
  ignition::math::Vector3d xyz;
  if (const sdf::Errors errors = axis.ResolveXyz(xyz, "__model__"); !errors.empty())
    throw BadModel({element + ": " + errors.front().Message()});
  AxisRule rule{.axis_W = (scope.X_WM.q_WB * vec3_of(xyz)).normalized(), .turns = turns};
  if (limited && std::abs(axis.Lower()) < kNoLimit) rule.low = axis.Lower();
  if (limited && std::abs(axis.Upper()) < kNoLimit) rule.high = axis.Upper();
  if (rule.low > rule.high)
    throw BadModel({fmt::format("{}: its limits, {} to {}, are the wrong way round", element, rule.low, rule.high)});
  rule.resistance = {.stiffness = axis.SpringStiffness(),
                     .rest = axis.SpringReference(),
                     .damping = axis.Damping(),
                     .friction = axis.Friction()};
  if (std::isfinite(axis.Effort()) && axis.Effort() > 0 && axis.Effort() < kNoBound)
    rule.drive = core::JointDrive{.max_effort = axis.Effort()};  // limit for later drives
  if (std::isfinite(axis.MaxVelocity()) && axis.MaxVelocity() >= 0 && axis.MaxVelocity() < kNoBound)
    model.note(element, "limit/velocity: a bound for a controller");
  return rule;
}

/// Returns the joint kind for one axis, or for two of which the first moves the second.
std::optional<SeveralAxes> kind_of(const sdf::Joint& joint, const SdfScope& scope, const std::string& element,
                                   Model& model) {
  const auto rule = [&](unsigned index, bool turns, bool limited) {
    const sdf::JointAxis* axis = joint.Axis(index);
    if (axis == nullptr) throw BadModel({element + ": it has no axis"});
    return rule_of(*axis, turns, limited, scope, element, model);
  };
  const auto one = [&](const AxisRule& of) { return SeveralAxes{one_axis_kind(of), axis_frame(of.axis_W)}; };
  switch (joint.Type()) {
    case sdf::JointType::REVOLUTE:
      return one(rule(0, true, true));
    case sdf::JointType::CONTINUOUS:
      return one(rule(0, true, false));
    case sdf::JointType::PRISMATIC:
      return one(rule(0, false, true));
    case sdf::JointType::BALL:
      return SeveralAxes{core::BallJoint{}, core::Quat::Identity()};
    case sdf::JointType::FIXED:
      return SeveralAxes{core::FixedJoint{}, core::Quat::Identity()};
    case sdf::JointType::UNIVERSAL:
    case sdf::JointType::REVOLUTE2:
      return several_axes_kind({rule(0, true, true), rule(1, true, true)}, element, model);
    default:
      return std::nullopt;
  }
}

std::string type_name(const sdf::Joint& joint) {
  return joint.Element() ? joint.Element()->Get<std::string>("type") : "of another type";
}

}  // namespace

void add_sdf_joint(const sdf::Joint& joint, const SdfScope& scope, const std::map<std::string, std::size_t>& links,
                   Model& model) {
  const std::string element = element_name("joint", scope.prefix + joint.Name());
  std::string child_name, parent_name;
  for (const sdf::Errors& errors : {joint.ResolveChildLink(child_name), joint.ResolveParentLink(parent_name)}) {
    if (!errors.empty()) throw BadModel({element + ": " + errors.front().Message()});
  }
  std::optional<std::size_t> child = end_of(child_name, scope, links, element);
  std::optional<std::size_t> parent = end_of(parent_name, scope, links, element);
  if (child && model.links[*child].is_static) child = std::nullopt;
  if (parent && model.links[*parent].is_static) parent = std::nullopt;
  if (!child && !parent) return model.note(element, "a joint of what never moves");
  if (!child) throw BadModel({element + ": its child is the world or a static link, allowed: a link that moves"});
  const std::optional<SeveralAxes> kind = kind_of(joint, scope, element, model);
  if (!kind) return model.lose(element, fmt::format("a {} joint with these axes: it is left out", type_name(joint)));
  core::Pose X_WJ = scope.X_WM * resolved(joint.SemanticPose(), "__model__", element);
  X_WJ.q_WB = kind->q_WJ;
  model.joints.push_back({scope.prefix + joint.Name(), kind->kind, *child, parent, X_WJ, false});
}

}  // namespace aurasim::importing
