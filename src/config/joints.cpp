#include "config/joints.h"

#include <limits>

#include <fmt/format.h>

#include "config/joint_keys.h"
#include "core/joint_ways.h"

namespace aurasim::config {
namespace {

using core::JointLimits;
using core::Vec3;

constexpr double kSmallestAxis = 1e-6;

/// Reads [low, high] and multiplies both by `unit`.
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

/// Reads [low, high], where a side may be `none`, and multiplies by `unit`.
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

/// Reads an axis, as the rotation whose z axis points along it.
core::Quat read_axis(const Field& field) {
  const Vec3 axis = field.given() ? field.vec3().value_or(Vec3::UnitZ()) : Vec3::UnitZ();
  if (axis.norm() < kSmallestAxis) {
    field.complain("found an axis of length 0, allowed: [x, y, z] that can be normalised");
    return core::Quat::Identity();
  }
  return core::Quat::FromTwoVectors(Vec3::UnitZ(), axis);
}

/// Further results of reading a kind of joint.
struct Reading {
  core::Quat q_WJ = core::Quat::Identity();
  std::optional<Field> leader;  ///< field with the name of the joint that this one follows
};

std::optional<core::JointCoupling> read_coupling(const Field& field, bool has_drive, Reading& joint) {
  if (!field.given()) return std::nullopt;
  if (!has_drive) field.complain("found no drive beside it, allowed: `follows` of a joint with a drive");
  const Fields fields(field);
  core::JointCoupling coupling;
  keys_of_coupling().read_members(fields, coupling);
  joint.leader = fields["joint"];
  fields.close();
  return coupling;
}

core::JointKind read_ball(const Fields& fields, Reading&) {
  core::BallJoint ball;
  keys_of_ball().read_members(fields, ball);
  return ball;
}

core::JointKind read_fixed(const Fields&, Reading&) { return core::FixedJoint{}; }

core::JointKind read_hinge(const Fields& fields, Reading& joint) {
  core::HingeJoint hinge;
  joint.q_WJ = read_axis(fields["axis"]);
  hinge.limits = read_open_limits(fields["limits_deg"], kDegree);
  keys_of_hinge().read_members(fields, hinge);
  const Field motor = fields["motor"];
  if (motor.given()) motor_keys().read(motor, hinge.motor.emplace());
  if (motor.given() && hinge.drive) motor.complain("found a motor beside a drive, allowed: one of them");
  hinge.follows = read_coupling(fields["follows"], hinge.drive.has_value(), joint);
  return hinge;
}

core::JointKind read_slider(const Fields& fields, Reading& joint) {
  joint.q_WJ = read_axis(fields["axis"]);
  core::SliderJoint slider{read_open_limits(fields["limits"], 1)};
  keys_of_slider().read_members(fields, slider);
  slider.follows = read_coupling(fields["follows"], slider.drive.has_value(), joint);
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

core::JointKind read_spring(const Fields& fields, Reading& joint) {
  core::SpringJoint spring;
  joint.q_WJ = read_orientation(fields["orientation"]);
  std::size_t i = 0;
  for (const char* name : {"x", "y", "z", "rx", "ry", "rz"}) {
    spring.axes[i] = read_spring_axis(fields[name], i >= 3);
    ++i;
  }
  return spring;
}

using KindReader = core::JointKind (*)(const Fields&, Reading&);
constexpr std::pair<std::string_view, KindReader> kKinds[] = {{"ball", read_ball},
                                                              {"hinge", read_hinge},
                                                              {"slider", read_slider},
                                                              {"fixed", read_fixed},
                                                              {"spring", read_spring}};

/// Reads the joint's kind. Returns the field with the name of the joint that it follows, if there is one.
std::optional<Field> read_kinds(const Fields& fields, core::JointSpec& joint) {
  Reading reading;
  for (const auto& [name, read] : kKinds) {
    if (!fields.has(name)) continue;
    const Fields settings(fields[name]);
    joint.kind = read(settings, reading);
    settings.close();
  }
  joint.X_WJ.q_WB = reading.q_WJ;
  return reading.leader;
}

/// Returns the places in the draft of a joint's one or two bodies.
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

/// A joint in SceneDraft::joints whose leader is still a name.
struct DraftFollower {
  std::size_t place = 0;
  Field leader;
};

void read_joint(const Field& field, SceneDraft& draft, std::vector<DraftFollower>& followers) {
  DraftJoint draft_joint;
  core::JointSpec& joint = draft_joint.joint;
  const Fields fields(field);
  const std::optional<Field> leader = read_kinds(fields, joint);
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
  if (leader && leader->given()) followers.push_back({draft.joints.size(), *leader});
  draft.joints.push_back(std::move(draft_joint));
}

core::JointWays ways_of(const SceneDraft& draft) {
  std::vector<core::JointEnds> ends;
  for (const DraftJoint& joint : draft.joints) {
    ends.push_back({joint.a, joint.b ? std::optional<std::uint64_t>(*joint.b) : std::nullopt});
  }
  return core::JointWays(std::move(ends));
}

/// Resolves the names of leaders to places among the file's joints. They stay places until the joints are numbered.
void find_leaders(const std::vector<DraftFollower>& followers, SceneDraft& draft) {
  if (followers.empty()) return;
  Names names("joint");
  for (const DraftJoint& joint : draft.joints) names.add(joint.joint.name);
  const core::JointWays ways = ways_of(draft);
  for (const DraftFollower& follower : followers) {
    const auto leader = names.find(follower.leader);
    if (!leader) continue;
    core::JointKind& kind = draft.joints[follower.place].joint.kind;
    const core::JointKind& lead = draft.joints[*leader].joint.kind;
    core::JointCoupling coupling = *core::coupling_of(kind);
    coupling.leader = core::JointId{*leader};
    core::couple(kind, coupling);
    if (!std::holds_alternative<core::HingeJoint>(lead) && !std::holds_alternative<core::SliderJoint>(lead)) {
      follower.leader.complain("found a joint of another kind, allowed: a hinge or slider");
    } else if (*leader == follower.place) {
      follower.leader.complain("found the joint itself, allowed: another one");
    } else if (ways.way(core::JointId{static_cast<std::uint32_t>(follower.place)}, coupling.leader).empty()) {
      follower.leader.complain(
          "found a joint of something else, allowed: one that a chain of joints binds to this one");
    }
  }
}

}  // namespace

void read_joints(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  std::vector<DraftFollower> followers;
  for (const Field& item : field.items()) read_joint(item, draft, followers);
  find_leaders(followers, draft);
}

void number_joints(SceneDraft& draft) {
  for (DraftJoint& joint : draft.joints) {
    joint.joint.a = draft.bodies[joint.a].body.id;
    if (joint.b) joint.joint.b = draft.bodies[*joint.b].body.id;
    draft.scene.joints.push_back(std::move(joint.joint));
  }
}

}  // namespace aurasim::config
