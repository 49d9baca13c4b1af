#include "config/joints.h"

#include <numbers>

#include <fmt/format.h>

namespace aurasim::config {
namespace {

using core::JointLimits;
using core::Vec3;

constexpr std::size_t kMostJoints = 1'000'000;
constexpr double kSmallestAxis = 1e-6;
constexpr double kDegree = std::numbers::pi / 180;
constexpr Range kAngleDeg = Range::from_to(-180, 180);

/// [low, high], in the unit of the result times `unit`.
std::optional<JointLimits> read_limits(const Field& field, const Range& range, double unit) {
  if (!field.given()) return std::nullopt;
  const auto values = field.numbers(2, range);
  if (!values) return std::nullopt;
  if ((*values)[0] > (*values)[1]) {
    field.refuse("[low, high] with low up to high");
    return std::nullopt;
  }
  return JointLimits{(*values)[0] * unit, (*values)[1] * unit};
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

core::JointKind read_ball(Fields&, core::Quat&) { return core::BallJoint{}; }

core::JointKind read_fixed(Fields&, core::Quat&) { return core::FixedJoint{}; }

core::JointKind read_hinge(Fields& fields, core::Quat& q_WJ) {
  core::HingeJoint hinge;
  q_WJ = read_axis(fields.optional("axis"));
  hinge.limits = read_limits(fields.optional("limits_deg"), kAngleDeg, kDegree);
  if (const Field motor_field = fields.optional("motor"); motor_field.given()) {
    Fields motor(motor_field);
    hinge.motor = core::JointMotor{motor.required("speed").number(Range::from_to(-1e4, 1e4)).value_or(0),
                                   motor.required("max_impulse").number(Range::from_to(0, 1e9)).value_or(0)};
    motor.close();
  }
  return hinge;
}

core::JointKind read_slider(Fields& fields, core::Quat& q_WJ) {
  q_WJ = read_axis(fields.optional("axis"));
  return core::SliderJoint{read_limits(fields.optional("limits"), kAnyNumber, 1)};
}

core::SpringAxis read_spring_axis(const Field& field, bool turns) {
  core::SpringAxis axis;
  if (!field.given()) {
    axis.limits = JointLimits{};
    return axis;
  }
  Fields fields(field);
  axis.limits = turns ? read_limits(fields.optional("limits_deg"), kAngleDeg, kDegree)
                      : read_limits(fields.optional("limits"), kAnyNumber, 1);
  if (const Field f = fields.optional("stiffness"); f.given()) {
    axis.stiffness = f.number(Range::from_to(0, 1e9)).value_or(0);
  }
  if (const Field f = fields.optional("damping"); f.given()) {
    axis.damping = f.number(Range::from_to(0, 1e9)).value_or(0);
  }
  fields.close();
  return axis;
}

core::JointKind read_spring(Fields& fields, core::Quat& q_WJ) {
  core::SpringJoint spring;
  q_WJ = read_orientation(fields.optional("orientation"));
  std::size_t i = 0;
  for (const char* name : {"x", "y", "z", "rx", "ry", "rz"}) {
    spring.axes[i] = read_spring_axis(fields.optional(name), i >= 3);
    ++i;
  }
  return spring;
}

using KindReader = core::JointKind (*)(Fields&, core::Quat&);
constexpr std::pair<const char*, KindReader> kKinds[] = {{"ball", read_ball},
                                                         {"hinge", read_hinge},
                                                         {"slider", read_slider},
                                                         {"fixed", read_fixed},
                                                         {"spring", read_spring}};

/// True if there is one kind, and only one.
bool read_kind(Fields& fields, core::JointSpec& joint) {
  int kinds = 0;
  for (const auto& [name, read] : kKinds) {
    const Field field = fields.optional(name);
    if (!field.given()) continue;
    ++kinds;
    Fields settings(field);
    joint.kind = read(settings, joint.X_WJ.q_WB);
    settings.close();
  }
  return kinds == 1;
}

/// The places of one or two bodies in the draft.
std::vector<std::size_t> read_ends(const Field& field, const SceneDraft& draft) {
  std::vector<std::size_t> places;
  if (!field.given()) {
    field.refuse("a list of 1 to 2");
    return {};
  }
  const std::vector<Field> items = field.items(1, 2);
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
  Fields fields(field);
  const bool has_one_kind = read_kind(fields, joint);
  const std::vector<std::size_t> ends = read_ends(fields.required("bodies"), draft);
  joint.name = fmt::format("joint {}", draft.joints.size());
  if (const Field name = fields.optional("name"); name.given()) joint.name = name.text("a name").value_or(joint.name);
  if (!ends.empty()) joint.X_WJ.p_WB = draft.bodies[ends[0]].body.pose.p_WB;
  if (const Field p = fields.optional("position"); p.given()) joint.X_WJ.p_WB = p.vec3().value_or(Vec3::Zero());
  if (const Field f = fields.optional("collide"); f.given()) joint.collide = f.flag().value_or(false);
  if (const Field f = fields.optional("break_impulse"); f.given()) {
    joint.break_impulse = f.number(Range::above(0, 1e9)).value_or(joint.break_impulse);
  }
  fields.close();
  if (fields.given() && !has_one_kind) field.refuse("one of ball, hinge, slider, fixed, spring");
  if (ends.empty()) return;
  draft_joint.a = ends[0];
  if (ends.size() == 2) draft_joint.b = ends[1];
  draft.joints.push_back(std::move(draft_joint));
}

}  // namespace

void read_joints(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const Field& item : field.items(0, kMostJoints)) read_joint(item, draft);
}

void number_joints(SceneDraft& draft) {
  for (DraftJoint& joint : draft.joints) {
    joint.joint.a = draft.bodies[joint.a].body.id;
    if (joint.b) joint.joint.b = draft.bodies[*joint.b].body.id;
    draft.scene.joints.push_back(std::move(joint.joint));
  }
}

}  // namespace aurasim::config
