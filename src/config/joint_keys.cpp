#include "config/joint_keys.h"

#include "config/joints.h"
#include "config/scene_draft.h"

namespace aurasim::config {
namespace {

using core::JointMotor;
using core::JointSpec;
using core::SpringAxis;

Key axis_key(std::string_view meaning) { return optional("axis", vec3(), meaning).usual("[0, 0, 1]"); }

Key limits_deg_key() {
  return optional("limits_deg", numbers(2, Range::from_to(-180, 180), "degrees"), "[low, high] of the angle")
      .otherwise("free");
}

Key limits_key() { return optional("limits", numbers(2, kAnyNumber, "m"), "[low, high] of the way").otherwise("free"); }

const KeyTable& ball_keys() {
  static const KeyTable keys{.title = "joint: ball",
                             .about = "Holds two points together, turns freely. It has no keys: `ball: {}`."};
  return keys;
}

const KeyTable& fixed_keys() {
  static const KeyTable keys{.title = "joint: fixed", .about = "Neither moves nor turns. It has no keys: `fixed: {}`."};
  return keys;
}

const KeyTable& hinge_keys() {
  static const KeyTable keys{
      .title = "joint: hinge",
      .about = "Turns about an axis.",
      .keys = {axis_key("[x, y, z] in the world at the start; of any length but 0"), limits_deg_key(),
               optional("motor", map(motor_keys), "turns it").otherwise("none")}};
  return keys;
}

const KeyTable& slider_keys() {
  static const KeyTable keys{
      .title = "joint: slider",
      .about = "Slides along an axis and does not turn.",
      .keys = {axis_key("[x, y, z] in the world at the start; of any length but 0"), limits_key()}};
  return keys;
}

const KeyTable& spring_keys() {
  static const KeyTable keys{
      .title = "joint: spring",
      .about = "Six axes, each locked (not given), free (`{}`), or a spring with limits at will.",
      .keys = {optional("orientation", map(orientation_keys), "of the axes, in the world at the start")
                   .otherwise("those of the world"),
               optional("x", map(sliding_axis_keys), "way along x").otherwise("locked"),
               optional("y", map(sliding_axis_keys), "way along y").otherwise("locked"),
               optional("z", map(sliding_axis_keys), "way along z").otherwise("locked"),
               optional("rx", map(turning_axis_keys), "turn about x").otherwise("locked"),
               optional("ry", map(turning_axis_keys), "turn about y").otherwise("locked"),
               optional("rz", map(turning_axis_keys), "turn about z").otherwise("locked")}};
  return keys;
}

}  // namespace

const KeysOf<JointMotor>& motor_keys() {
  static const KeysOf<JointMotor> keys(
      "joint: hinge: motor", "Turns body A relative to B.",
      {
          required("speed", &JointMotor::speed, number(Range::from_to(-1e4, 1e4), "rad/s"), "that it strives for"),
          required("max_impulse", &JointMotor::max_impulse, number(Range::from_to(0, 1e9), "N m s"),
                   "at most, in 1/240 s, at any step and substeps"),
      });
  return keys;
}

const KeysOf<SpringAxis>& sliding_axis_keys() {
  static const KeysOf<SpringAxis> keys(
      "joint: spring: x, y, z", "A way along an axis. `{}` is free.",
      {
          limits_key(),
          optional("stiffness", &SpringAxis::stiffness, number(Range::from_to(0, 1e9), "N/m"), "towards the start"),
          optional("damping", &SpringAxis::damping, number(Range::from_to(0, 1e9), "N s/m"), "against motion"),
      });
  return keys;
}

const KeysOf<SpringAxis>& turning_axis_keys() {
  static const KeysOf<SpringAxis> keys(
      "joint: spring: rx, ry, rz", "A turn about an axis. `{}` is free.",
      {
          limits_deg_key(),
          optional("stiffness", &SpringAxis::stiffness, number(Range::from_to(0, 1e9), "N m/rad"), "towards the start"),
          optional("damping", &SpringAxis::damping, number(Range::from_to(0, 1e9), "N m s/rad"), "against turning"),
      });
  return keys;
}

const KeysOf<JointSpec>& keys_of_joint() {
  static const KeysOf<JointSpec> keys(
      "joint",
      "Exactly one kind, and what all kinds take. Angles and ways are those of the first body relative to the second.",
      {
          optional("ball", map(ball_keys), "turns freely about a point"),
          optional("hinge", map(hinge_keys), "turns about an axis"),
          optional("slider", map(slider_keys), "slides along an axis"),
          optional("fixed", map(fixed_keys), "neither"),
          optional("spring", map(spring_keys), "six axes: locked, free or sprung"),
          required("bodies", list(1, 2, name_of("named body")), "[A, B]: names of bodies; [A] joins A to the world"),
          own_name_key("by which reports refer to it", "`joint N`, N from 0 in the order of the file"),
          optional("position", vec3("m"), "of the joint in the world at the start").otherwise("that of body A"),
          optional("collide", &JointSpec::collide, flag(), "whether A and B collide with each other"),
          optional("break_impulse", &JointSpec::break_impulse, number(Range::above(0, 1e9), "N s or N m s"),
                   "breaks for good when it takes more in 1/240 s, or as much for longer or shorter substeps")
              .otherwise("it never breaks"),
      },
      {"ball", "hinge", "slider", "fixed", "spring"});
  return keys;
}

const KeyTable& joint_keys() { return keys_of_joint(); }

}  // namespace aurasim::config
