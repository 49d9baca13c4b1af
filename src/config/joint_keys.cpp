#include "config/joint_keys.h"

#include <limits>

#include "config/joints.h"
#include "config/scene_draft.h"

namespace aurasim::config {
namespace {

using core::JointMotor;
using core::JointSpec;
using core::SpringAxis;

const KeyTable& coupling_keys() { return keys_of_coupling(); }

Key axis_key(std::string_view meaning) { return optional("axis", vec3(), meaning).usual("[0, 0, 1]"); }

const Range kTurns_deg = Range::from_to(-360'000, 360'000);
const Range kGain = Range::from_to(0, 1e9);

Key turning_limits_key() {
  return optional("limits_deg", list(2, 2, number(kTurns_deg, "degrees").or_word("none")),
                  "[low, high] of the angle, which goes on beyond half a turn; `none`: not on this side")
      .otherwise("free");
}

Key sliding_limits_key() {
  return optional("limits", list(2, 2, number(kAnyNumber, "m").or_word("none")),
                  "[low, high] of the way; `none`: not on this side")
      .otherwise("free");
}

Key limits_deg_key() {
  return optional("limits_deg", numbers(2, Range::from_to(-180, 180), "degrees"), "[low, high] of the angle")
      .otherwise("free");
}

/// Key of an angle in degrees whose member is in radians.
template <class T>
KeyOf<T> degrees(std::string_view name, double T::*member, std::string_view meaning) {
  return {optional(name, number(kTurns_deg, "degrees"), meaning).usual("0"), [member](const Field& field, T& object) {
            if (const auto angle = field.number()) object.*member = *angle * kDegree;
          }};
}

/// Makes a key of T's part usable as a key of T.
template <class T, class Part>
KeyOf<T> of_part(Part T::*part, KeyOf<Part> key) {
  return {std::move(key.key),
          [part, store = std::move(key.store)](const Field& field, T& object) { store(field, object.*part); }};
}

/// Keys of a joint's own resistance (stiffness, damping, friction), for a joint that turns or slides.
template <class T>
std::vector<KeyOf<T>> resistance_keys(bool turns) {
  using core::JointResistance;
  const auto part = &T::resistance;
  KeyOf<JointResistance> rest =
      turns ? degrees("rest_deg", &JointResistance::rest, "where its stiffness pulls")
            : optional("rest", &JointResistance::rest, number(kAnyNumber, "m"), "where its stiffness pulls");
  return {of_part(part, optional("stiffness", &JointResistance::stiffness, number(kGain, turns ? "N m/rad" : "N/m"),
                                 "of its own, whatever drives it")),
          of_part(part, std::move(rest)),
          of_part(part, optional("damping", &JointResistance::damping, number(kGain, turns ? "N m s/rad" : "N s/m"),
                                 "against motion")),
          of_part(part, optional("friction", &JointResistance::friction, number(kGain, turns ? "N m" : "N"),
                                 "Coulomb's: against motion by as much, however slow"))};
}

std::vector<KeyOf<core::JointDrive>> drive_rows(bool turns) {
  using core::JointDrive;
  const Range any = Range::from_to(-1e9, 1e9);
  KeyOf<JointDrive> position =
      turns ? degrees("position_deg", &JointDrive::position, "that it strives for")
            : optional("position", &JointDrive::position, number(kAnyNumber, "m"), "that it strives for");
  return {
      std::move(position),
      optional("speed", &JointDrive::speed, number(Range::from_to(-1e4, 1e4), turns ? "rad/s" : "m/s"),
               "that it strives for"),
      optional("stiffness", &JointDrive::stiffness, number(kGain, turns ? "N m/rad" : "N/m"),
               "effort for each unit that it is from `position`"),
      optional("damping", &JointDrive::damping, number(kGain, turns ? "N m s/rad" : "N s/m"),
               "effort for each unit that it is from `speed`"),
      optional("effort", &JointDrive::effort, number(any, turns ? "N m" : "N"), "besides"),
      optional("max_effort", &JointDrive::max_effort, number(kGain, turns ? "N m" : "N"), "at most, either way, in all")
          .otherwise("no bound")};
}

template <class T>
std::vector<KeyOf<T>> joined(std::vector<KeyOf<T>> rows, std::vector<KeyOf<T>> more) {
  for (KeyOf<T>& row : more) rows.push_back(std::move(row));
  return rows;
}

/// Key of a drive, which exists if and only if the key does.
template <class T>
KeyOf<T> drive_key(const KeysOf<core::JointDrive>& (*table)()) {
  return {optional("drive", map(table), "strives for a position or a speed, or pushes").otherwise("none"),
          [table](const Field& field, T& joint) { table().read(field, joint.drive.emplace()); }};
}

Key follows_key() {
  return optional("follows", map(coupling_keys), "its drive strives for where another joint is").otherwise("none");
}

const KeyTable& ball_keys() { return keys_of_ball(); }
const KeyTable& hinge_keys() { return keys_of_hinge(); }
const KeyTable& slider_keys() { return keys_of_slider(); }

const KeyTable& fixed_keys() {
  static const KeyTable keys{.title = "joint: fixed",
                             .about = "A joint that neither moves nor turns. It has no keys: `fixed: {}`."};
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

const KeysOf<core::BallJoint>& keys_of_ball() {
  static const KeysOf<core::BallJoint> keys(
      "joint: ball", "Holds two points together, turns freely.",
      {optional("damping", &core::BallJoint::damping, number(kGain, "N m s/rad"), "against turning, about any axis")});
  return keys;
}

const KeysOf<core::HingeJoint>& keys_of_hinge() {
  static const KeysOf<core::HingeJoint> keys(
      "joint: hinge", "Turns about an axis. Its angle is 0 at the start.",
      joined<core::HingeJoint>(
          {axis_key("[x, y, z] in the world at the start; of any length but 0"), turning_limits_key(),
           optional("motor", map(motor_keys), "turns it; not beside a drive").otherwise("none"),
           drive_key<core::HingeJoint>(turning_drive_keys), follows_key()},
          resistance_keys<core::HingeJoint>(true)));
  return keys;
}

const KeysOf<core::SliderJoint>& keys_of_slider() {
  static const KeysOf<core::SliderJoint> keys(
      "joint: slider", "Slides along an axis and does not turn. Its way is 0 at the start.",
      joined<core::SliderJoint>({axis_key("[x, y, z] in the world at the start; of any length but 0"),
                                 sliding_limits_key(), drive_key<core::SliderJoint>(sliding_drive_keys), follows_key()},
                                resistance_keys<core::SliderJoint>(false)));
  return keys;
}

const KeysOf<core::JointDrive>& turning_drive_keys() {
  static const KeysOf<core::JointDrive> keys("joint: hinge: drive",
                                             "stiffness (position - angle) + damping (speed - its rate) + effort; "
                                             "solved implicitly, so any stiffness is stable.",
                                             drive_rows(true));
  return keys;
}

const KeysOf<core::JointDrive>& sliding_drive_keys() {
  static const KeysOf<core::JointDrive> keys("joint: slider: drive",
                                             "stiffness (position - way) + damping (speed - its rate) + effort; solved "
                                             "implicitly, so any stiffness is stable.",
                                             drive_rows(false));
  return keys;
}

const KeysOf<core::JointCoupling>& keys_of_coupling() {
  using core::JointCoupling;
  static const KeysOf<JointCoupling> keys(
      "joint: hinge, slider: follows",
      "Its drive strives for `position` and `ratio` times where the other joint is, and likewise for the speed: a "
      "gear, "
      "or fingers of a gripper. Nothing pushes back on the other joint. The drive rests once a joint between the two "
      "is "
      "gone.",
      {
          required("joint", name_of("joint"),
                   "a hinge or slider of the same file that a chain of joints binds to this one"),
          optional("ratio", &JointCoupling::ratio, number(Range::from_to(-1e6, 1e6), "rad or m for each rad or m"),
                   "its way for each unit of the other's"),
      });
  return keys;
}

const KeysOf<SpringAxis>& sliding_axis_keys() {
  static const KeysOf<SpringAxis> keys(
      "joint: spring: x, y, z", "A way along an axis. `{}` is free.",
      {
          sliding_limits_key(),
          optional("stiffness", &SpringAxis::stiffness, number(Range::from_to(0, 1e9), "N/m"), "towards `rest`"),
          optional("rest", &SpringAxis::rest, number(kAnyNumber, "m"), "where the stiffness pulls, from the start"),
          optional("damping", &SpringAxis::damping, number(Range::from_to(0, 1e9), "N s/m"), "against motion"),
      });
  return keys;
}

const KeysOf<SpringAxis>& turning_axis_keys() {
  static const KeysOf<SpringAxis> keys(
      "joint: spring: rx, ry, rz", "A turn about an axis. `{}` is free.",
      {
          limits_deg_key(),
          optional("stiffness", &SpringAxis::stiffness, number(Range::from_to(0, 1e9), "N m/rad"), "towards `rest`"),
          degrees("rest_deg", &SpringAxis::rest, "where the stiffness pulls, from the start"),
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
          optional("position", vec3("m", kPlace), "of the joint in the world at the start").otherwise("that of body A"),
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
