#include "import/mjcf_joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "import/couplings.h"
#include "import/joints.h"

namespace aurasim::importing {
namespace {

constexpr double kSamePlace_m = 1e-9;

/// Limit of an actuator's force on the joint, either way; infinite if there is none.
double most_of(const mjModel& m, int actuator, double gear, const std::string& element, Model& model) {
  if (!m.actuator_forcelimited[actuator]) return core::JointDrive{}.max_effort;
  const double low = m.actuator_forcerange[2 * actuator], high = m.actuator_forcerange[2 * actuator + 1];
  if (low != -high)
    model.lose(element, fmt::format("forcerange {} to {}: a scene's bound is the same either way", low, high));
  return std::abs(gear) * std::max(std::abs(low), std::abs(high));
}

/// Drive that equals the position and velocity actuators at a control of 0, from where the joint starts. Nothing if
/// there are none.
std::optional<core::JointDrive> drive_of(const mjModel& m, int joint, double start, const std::string& element,
                                         Model& model) {
  std::optional<core::JointDrive> drive;
  double pull = 0;  ///< force at the start
  for (int a = 0; a < m.nu; ++a) {
    const bool drives = (m.actuator_trntype[a] == mjTRN_JOINT || m.actuator_trntype[a] == mjTRN_JOINTINPARENT) &&
                        m.actuator_trnid[2 * a] == joint;
    if (!drives) continue;
    const std::string actuator = element_name("actuator", mjcf_name(m, mjOBJ_ACTUATOR, a, "actuator"));
    const mjtNum* bias = m.actuator_biasprm + mjNBIAS * a;
    const bool plain = m.actuator_dyntype[a] == mjDYN_NONE && m.actuator_gaintype[a] == mjGAIN_FIXED;
    if (!plain || (m.actuator_biastype[a] != mjBIAS_AFFINE && m.actuator_biastype[a] != mjBIAS_NONE)) {
      model.lose(actuator, fmt::format("it drives {} in a way that a scene has not", element));
      continue;
    }
    if (!drive) drive = core::JointDrive{.max_effort = 0};
    const double gear = m.actuator_gear[6 * a];
    drive->max_effort += most_of(m, a, gear, actuator, model);
    if (m.actuator_biastype[a] == mjBIAS_AFFINE) {
      drive->stiffness -= gear * gear * bias[1];
      drive->damping -= gear * gear * bias[2];
      pull += gear * (bias[0] + bias[1] * gear * start);
    }
    model.note(actuator, "its control: a scene has it at 0");
  }
  if (!drive) return drive;
  if (drive->stiffness > 0) {
    drive->position = pull / drive->stiffness;
  } else {
    drive->effort = pull;
  }
  return drive;
}

AxisRule mjcf_rule(const mjModel& m, const mjData& d, int joint, const std::string& element, Model& model) {
  const int dof = m.jnt_dofadr[joint];
  const double start = m.qpos0[m.jnt_qposadr[joint]];
  AxisRule rule{.axis_W = mj_vec3(d.xaxis + 3 * joint), .turns = m.jnt_type[joint] == mjJNT_HINGE};
  if (m.jnt_limited[joint]) {
    rule.low = m.jnt_range[2 * joint] - start;
    rule.high = m.jnt_range[2 * joint + 1] - start;
  }
  rule.resistance = {.stiffness = m.jnt_stiffness[joint],
                     .rest = m.qpos_spring[m.jnt_qposadr[joint]] - start,
                     .damping = m.dof_damping[dof],
                     .friction = m.dof_frictionloss[dof]};
  rule.drive = drive_of(m, joint, start, element, model);
  double own[] = {rule.resistance.stiffness, rule.resistance.damping};
  double* const gains[] = {&rule.resistance.stiffness, &rule.resistance.damping,
                           rule.drive ? &rule.drive->stiffness : own, rule.drive ? &rule.drive->damping : own + 1};
  if (std::ranges::any_of(gains, [](const double* gain) { return *gain < 0; })) {
    model.lose(element, "a stiffness or damping below 0: taken for 0");
    for (double* gain : gains) *gain = std::max(*gain, 0.0);
  }
  return rule;
}

void tell_of_dofs(const mjModel& m, int joint, const std::string& element, Model& model) {
  const int count = m.jnt_type[joint] == mjJNT_FREE ? 6 : m.jnt_type[joint] == mjJNT_BALL ? 3 : 1;
  for (int dof = m.jnt_dofadr[joint]; dof < m.jnt_dofadr[joint] + count; ++dof) {
    if (count > 1 && m.dof_frictionloss[dof] != 0) return model.lose(element, "frictionloss of a ball or free joint");
    if (m.dof_armature[dof] != 0) return model.lose(element, "armature");
  }
}

/// Adds findings about properties of joints with three or six degrees of freedom, beyond those that hold them.
void tell_of_wide_joint(const mjModel& m, int joint, const std::string& element, Model& model) {
  if (m.jnt_type[joint] == mjJNT_FREE && m.dof_damping[m.jnt_dofadr[joint]] != 0)
    model.lose(element, "damping of a free joint");
  if (m.jnt_stiffness[joint] != 0) model.lose(element, "stiffness of a ball or free joint");
  if (m.jnt_limited[joint]) model.lose(element, "the limit of a ball joint");
}

struct Parts {
  std::vector<AxisRule> rules;
  std::vector<core::Vec3> anchors;  ///< anchors of the turning axes
  int balls = 0, frees = 0;
  double ball_damping = 0;
};

/// Returns the joint for all joints of a body; nothing if a scene has no such joint.
std::optional<SeveralAxes> mjcf_kind(const Parts& parts, const std::string& element, Model& model) {
  if (parts.balls == 1 && parts.rules.empty())
    return SeveralAxes{core::BallJoint{parts.ball_damping}, core::Quat::Identity()};
  if (parts.balls > 0) return std::nullopt;
  if (parts.rules.size() == 1) {
    const AxisRule& rule = parts.rules.front();
    return SeveralAxes{one_axis_kind(rule), axis_frame(rule.axis_W)};
  }
  for (const core::Vec3& anchor : parts.anchors) {
    if ((anchor - parts.anchors.front()).norm() > kSamePlace_m) return std::nullopt;
  }
  return several_axes_kind(parts.rules, element, model);
}

struct EqualityEnds {
  std::size_t child = 0;
  std::optional<std::size_t> parent;
};

/// Returns the ends of an equality; nothing if neither end moves, or both are one link.
std::optional<EqualityEnds> ends_of(const std::optional<std::size_t>& a, const std::optional<std::size_t>& b) {
  if ((!a && !b) || a == b) return std::nullopt;
  return a ? EqualityEnds{*a, b} : EqualityEnds{*b, std::nullopt};
}

/// True when a weld holds its bodies in their present poses.
bool holds_as_it_stands(const mjData& d, const mjtNum* data, int body1, int body2) {
  const core::Pose X_W1{mj_vec3(d.xpos + 3 * body1), mj_quat(d.xquat + 4 * body1)};
  const core::Pose X_W2{mj_vec3(d.xpos + 3 * body2), mj_quat(d.xquat + 4 * body2)};
  const core::Pose X_12 = inverse(X_W1) * X_W2;
  // MuJoCo 2.2: data is anchor, relpos, relquat. The anchor is a point of body 2, relpos the place of body 2's frame in
  // body 1.
  const core::Vec3 point_2 = mj_vec3(data), relpos = mj_vec3(data + 3);
  const core::Vec3 held = X_12.p_WB + X_12.q_WB * point_2;
  return (held - relpos).norm() < 1e-6 && X_12.q_WB.angularDistance(mj_quat(data + 6)) < 1e-6;
}

/// Couples a joint that is a polynomial of another one.
void couple_joints(const mjModel& m, int equality, const std::string& element, Model& model) {
  const int joint1 = m.eq_obj1id[equality], joint2 = m.eq_obj2id[equality];
  const mjtNum* data = m.eq_data + mjNEQDATA * equality;
  if (joint2 < 0) return model.lose(element, "joint: it holds a joint at a place; in a scene it moves");
  const std::string name = mjcf_name(m, mjOBJ_JOINT, joint1, "joint"),
                    other = mjcf_name(m, mjOBJ_JOINT, joint2, "joint");
  const auto here = find_joint(model, name), there = find_joint(model, other);
  const std::string what = fmt::format("joint: '{}' and '{}' move together", name, other);
  const auto lose = [&](std::string_view why) {
    model.lose(element, fmt::format("{} ({}); in a scene each moves on its own", what, why));
  };
  if (!here || !there) return lose("one of them is left out");
  if (std::any_of(data + 2, data + 5, [](mjtNum coefficient) { return coefficient != 0; }))
    return lose("by a curve, not a line");
  if (const std::string why = follow(*here, *there, data[1], data[0], model); !why.empty()) return lose(why);
  model.lose(element, what + "; in a scene the first follows the second, which nothing holds back");
}

const char* equality_kind(int type) {
  switch (type) {
    case mjEQ_TENDON:
      return "tendon: a tendon of a given length";
    default:
      return "distance: two geoms at a given distance";
  }
}

}  // namespace

std::string mjcf_name(const mjModel& m, int type, int id, const char* kind) {
  const char* name = mj_id2name(&m, type, id);
  return name != nullptr && *name != '\0' ? name : fmt::format("{} {}", kind, id);
}

void add_mjcf_joints(const mjModel& m, const mjData& d, int body, const LinkOfBody& link_of, Model& model) {
  const int first = m.body_jntadr[body], count = m.body_jntnum[body];
  if (count == 0) return;
  Parts parts;
  const std::string name = mjcf_name(m, mjOBJ_JOINT, first, "joint");
  for (int joint = first; joint < first + count; ++joint) {
    const std::string element = element_name("joint", mjcf_name(m, mjOBJ_JOINT, joint, "joint"));
    tell_of_dofs(m, joint, element, model);
    if (m.jnt_type[joint] == mjJNT_FREE || m.jnt_type[joint] == mjJNT_BALL) {
      tell_of_wide_joint(m, joint, element, model);
      ++(m.jnt_type[joint] == mjJNT_FREE ? parts.frees : parts.balls);
      parts.ball_damping = m.dof_damping[m.jnt_dofadr[joint]];
    } else {
      parts.rules.push_back(mjcf_rule(m, d, joint, element, model));
    }
    if (m.jnt_type[joint] != mjJNT_SLIDE) parts.anchors.push_back(mj_vec3(d.xanchor + 3 * joint));
  }
  if (parts.frees > 0) return;
  const std::string element = element_name("joint", name);
  const std::optional<SeveralAxes> kind = mjcf_kind(parts, element, model);
  if (!kind) {
    return model.lose(element_name("body", mjcf_name(m, mjOBJ_BODY, body, "body")),
                      fmt::format("its {} joints together: they are left out, and it is free", count));
  }
  const core::Vec3 p_WJ = parts.anchors.empty() ? mj_vec3(d.xanchor + 3 * first) : parts.anchors.front();
  model.joints.push_back({name, kind->kind, *link_of[body], link_of[m.body_parentid[body]], {p_WJ, kind->q_WJ}, false});
}

void add_mjcf_equalities(const mjModel& m, const mjData& d, const LinkOfBody& link_of, Model& model) {
  for (int e = 0; e < m.neq; ++e) {
    const std::string name = mjcf_name(m, mjOBJ_EQUALITY, e, "equality");
    const std::string element = element_name("equality", name);
    if (!m.eq_active[e]) {
      model.note(element, "it is not active");
      continue;
    }
    if (m.eq_type[e] == mjEQ_JOINT) {
      couple_joints(m, e, element, model);
      continue;
    }
    const int type = m.eq_type[e], body1 = m.eq_obj1id[e], body2 = m.eq_obj2id[e];
    const mjtNum* data = m.eq_data + mjNEQDATA * e;
    if (type != mjEQ_CONNECT && type != mjEQ_WELD) {
      model.lose(element, equality_kind(type));
      continue;
    }
    const auto ends = ends_of(link_of[body1], link_of[body2]);
    if (!ends) continue;
    if (type == mjEQ_WELD && !holds_as_it_stands(d, data, body1, body2)) {
      model.lose(element, "a weld that first has to pull its bodies together: it is left out");
      continue;
    }
    // The anchor of a connect is a point of body 1.
    const core::Pose X_W1{mj_vec3(d.xpos + 3 * body1), mj_quat(d.xquat + 4 * body1)};
    const core::Vec3 p_WJ = type == mjEQ_CONNECT ? core::Vec3(X_W1.p_WB + X_W1.q_WB * mj_vec3(data)) : X_W1.p_WB;
    const core::JointKind kind =
        type == mjEQ_CONNECT ? core::JointKind(core::BallJoint{}) : core::JointKind(core::FixedJoint{});
    model.joints.push_back({name, kind, ends->child, ends->parent, {p_WJ, core::Quat::Identity()}, true});
  }
}

}  // namespace aurasim::importing
