#include "config/joints.h"

#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "config/joint_keys.h"

namespace aurasim::config {
namespace {

using core::JointLimits;
using core::Vec3;

constexpr double kSmallestAxis = 1e-6;
constexpr double kDegree = std::numbers::pi / 180;

/// [low, high], in the unit of the result times `unit`.
std::optional<JointLimits> read_limits(const Field& field, double unit) {
  if (!field.given()) return std::nullopt;
  const auto values = field.numbers();
  if (!values) return std::nullopt;
  if ((*values)[0] > (*values)[1]) {
    field.refuse("[low, high] with low up to high");
    return std::nullopt;
  }
  return JointLimits{(*values)[0] * unit, (*values)[1] * unit};
}

/// The same, where a side may be `none`.
std::optional<JointLimits> read_open_limits(const Field& field, double unit) {
  if (!field.given()) return std::nullopt;
  const std::vector<Field> sides = field.items();
  if (sides.size() != 2) return std::nullopt;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto side = [unit](const Field& of, double none) -> std::optional<double> {
    if (of.is_word("none")) return none;
    const auto value = of.number();
    return value ? std::optional(*value * unit) : std::nullopt;
  };
  const auto low = side(sides[0], -kNone), high = side(sides[1], kNone);
  if (!low || !high) return std::nullopt;
  if (*low > *high) {
    field.refuse("[low, high] with low up to high");
    return std::nullopt;
  }
  if (*low == -kNone && *high == kNone) return std::nullopt;
  return JointLimits{*low, *high};
}

/// The joint's z axis points along it.
core::Quat read_axis(const Field& field) {
  const Vec3 axis = field.given() ? field.vec3().value_or(Vec3::UnitZ()) : Vec3::UnitZ();
  if (axis.norm() < kSmallestAxis) {
    field.complain("found an axis of length 0, allowed: [x, y, z] that can be normalised");
    return core::Quat::Identity();
  }
  return core::Quat::FromTwoVectors(Vec3::UnitZ(), axis);
}

core::JointKind read_ball(const Fields& fields, core::Quat&) {
  core::BallJoint ball;
  keys_of_ball().read_members(fields, ball);
  return ball;
}

core::JointKind read_fixed(const Fields&, core::Quat&) { return core::FixedJoint{}; }

core::JointKind read_hinge(const Fields& fields, core::Quat& q_WJ) {
  core::HingeJoint hinge;
  q_WJ = read_axis(fields["axis"]);
  hinge.limits = read_open_limits(fields["limits_deg"], kDegree);
  keys_of_hinge().read_members(fields, hinge);
  const Field motor = fields["motor"];
  if (motor.given()) motor_keys().read(motor, hinge.motor.emplace());
  if (motor.given() && hinge.drive) motor.complain("found a motor beside a drive, allowed: one of them");
  return hinge;
}

core::JointKind read_slider(const Fields& fields, core::Quat& q_WJ) {
  q_WJ = read_axis(fields["axis"]);
  core::SliderJoint slider{read_open_limits(fields["limits"], 1)};
  keys_of_slider().read_members(fields, slider);
  return slider;
}

core::SpringAxis read_spring_axis(const Field& field, bool turns) {
  core::SpringAxis axis;
  if (!field.given()) {
    axis.limits = JointLimits{};
    return axis;
  }
  const Fields fields(field);
  axis.limits = turns ? read_limits(fields["limits_deg"], kDegree) : read_open_limits(fields["limits"], 1);
  (turns ? turning_axis_keys() : sliding_axis_keys()).read_members(fields, axis);
  fields.close();
  return axis;
}

core::JointKind read_spring(const Fields& fields, core::Quat& q_WJ) {
  core::SpringJoint spring;
  q_WJ = read_orientation(fields["orientation"]);
  std::size_t i = 0;
  for (const char* name : {"x", "y", "z", "rx", "ry", "rz"}) {
    spring.axes[i] = read_spring_axis(fields[name], i >= 3);
    ++i;
  }
  return spring;
}

using KindReader = core::JointKind (*)(const Fields&, core::Quat&);
constexpr std::pair<std::string_view, KindReader> kKinds[] = {{"ball", read_ball},
                                                              {"hinge", read_hinge},
                                                              {"slider", read_slider},
                                                              {"fixed", read_fixed},
                                                              {"spring", read_spring}};

void read_kinds(const Fields& fields, core::JointSpec& joint) {
  for (const auto& [name, read] : kKinds) {
    if (!fields.has(name)) continue;
    const Fields settings(fields[name]);
    joint.kind = read(settings, joint.X_WJ.q_WB);
    settings.close();
  }
}

/// The places of one or two bodies in the draft.
std::vector<std::size_t> read_ends(const Field& field, const SceneDraft& draft) {
  std::vector<std::size_t> places;
  if (!field.given()) {
    field.refuse("a list of 1 to 2");
    return {};
  }
  const std::vector<Field> items = field.items();
  for (const Field& item : items) {
    if (const auto name = draft.body_names.find(item)) places.push_back(draft.named_bodies[*name]);
  }
  if (places.size() == 2 && places[0] == places[1]) {
    field.complain("found the same body twice, allowed: two bodies, or one, which is joined to the world");
    return {};
  }
  return places.size() == items.size() ? places : std::vector<std::size_t>{};
}

void read_joint(const Field& field, SceneDraft& draft) {
  DraftJoint draft_joint;
  core::JointSpec& joint = draft_joint.joint;
  const Fields fields(field);
  read_kinds(fields, joint);
  const std::vector<std::size_t> ends = read_ends(fields["bodies"], draft);
  joint.name = fields["name"].text().value_or(fmt::format("joint {}", draft.joints.size()));
  if (!ends.empty()) joint.X_WJ.p_WB = draft.bodies[ends[0]].body.pose.p_WB;
  joint.X_WJ.p_WB = fields["position"].vec3().value_or(joint.X_WJ.p_WB);
  keys_of_joint().read_members(fields, joint);
  fields.close();
  if (fields.given() && fields.given_of(joint_keys()).size() != 1) {
    field.refuse("one of ball, hinge, slider, fixed, spring");
  }
  if (ends.empty()) return;
  draft_joint.a = ends[0];
  if (ends.size() == 2) draft_joint.b = ends[1];
  draft.joints.push_back(std::move(draft_joint));
}

}  // namespace

void read_joints(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const Field& item : field.items()) read_joint(item, draft);
}

void number_joints(SceneDraft& draft) {
  for (DraftJoint& joint : draft.joints) {
    joint.joint.a = draft.bodies[joint.a].body.id;
    if (joint.b) joint.joint.b = draft.bodies[*joint.b].body.id;
    draft.scene.joints.push_back(std::move(joint.joint));
  }
}

}  // namespace aurasim::config
