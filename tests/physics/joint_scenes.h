// Bodies and joints for scenes, one by one, and creatures and machines of them.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "physics/scenes.h"

namespace aurasim::physics::testing {

/// With the next id.
inline core::InitialBody& place_body(core::Scene& scene, int kind, const core::Vec3& p_WB) {
  core::InitialBody& body = scene.bodies.emplace_back();
  body.id = core::BodyId{scene.bodies.size() - 1};
  body.prototype = core::PrototypeId{static_cast<std::uint32_t>(kind)};
  body.pose.p_WB = p_WB;
  return body;
}

inline core::JointSpec& add_joint(core::Scene& scene, core::JointKind kind, std::uint64_t a,
                                  std::optional<std::uint64_t> b, const core::Vec3& p_WJ,
                                  const core::Vec3& axis = core::Vec3::UnitZ()) {
  core::JointSpec& joint = scene.joints.emplace_back();
  joint.kind = std::move(kind);
  joint.a = core::BodyId{a};
  if (b) joint.b = core::BodyId{*b};
  joint.X_WJ = {p_WJ, core::Quat::FromTwoVectors(core::Vec3::UnitZ(), axis)};
  return joint;
}

inline std::vector<core::BodyRecord> initial_records(const core::Scene& scene) {
  std::vector<core::BodyRecord> records;
  for (const core::InitialBody& body : scene.bodies) records.push_back(core::initial_record(body));
  return records;
}

/// A creature of all kinds of joints at (x, 0), thrown onto the ground: a box with a leg of every kind, of which that
/// on the spring ends in a chain.
inline std::vector<core::BodyId> place_creature(core::Scene& scene, double x, const core::Vec3& v_WB) {
  const std::uint64_t first = scene.bodies.size();
  core::SpringJoint spring;
  for (std::size_t i = 0; i < 6; ++i) spring.axes[i] = {core::JointLimits{-0.2, 0.2}, i < 3 ? 300.0 : 20.0, 1};
  const core::HingeJoint motor{{}, core::JointMotor{4, 0.05}};
  const core::HingeJoint limited{core::JointLimits{-0.5, 0.5}, {}};
  const core::JointKind kinds[] = {core::BallJoint{},  motor, limited, core::SliderJoint{core::JointLimits{-0.2, 0.3}},
                                   core::FixedJoint{}, spring};
  place_body(scene, kBox, {x, 0, 3});
  for (std::size_t i = 0; i < 6; ++i) {
    const double angle = 1.1 * static_cast<double>(i);
    const core::Vec3 outward(std::cos(angle), std::sin(angle), 0.2);
    const auto leg = scene.bodies.size();
    place_body(scene, static_cast<int>(i) % 3, core::Vec3(x, 0, 3) + outward);
    // The motor's leg comes last in the order of ids but first in that of joints, and so on: no order is the other's.
    if (i % 2 == 0) {
      add_joint(scene, kinds[i], first, leg, core::Vec3(x, 0, 3) + 0.5 * outward,
                outward.cross(core::Vec3::UnitZ()).normalized());
    } else {
      add_joint(scene, kinds[i], leg, first, core::Vec3(x, 0, 3) + 0.5 * outward, outward.normalized());
    }
  }
  for (int i = 0; i < 4; ++i) {
    const auto last = scene.bodies.size() - 1;
    const core::Vec3 end = scene.bodies.back().pose.p_WB;
    place_body(scene, kCapsule, end + core::Vec3(0, 0, 1.3));
    add_joint(scene, core::BallJoint{}, last + 1, last, end + core::Vec3(0, 0, 0.65)).collide = true;
    scene.joints.back().break_impulse = i == 3 ? 0.35 : 1e6;
  }
  std::vector<core::BodyId> ids;
  for (std::uint64_t id = first; id < scene.bodies.size(); ++id) {
    scene.bodies[id].v_WB = v_WB;
    ids.push_back(core::BodyId{id});
  }
  return ids;
}

/// A box that drives: two wheels on hinges, of which one turns without end and one goes to and fro by a stiff drive,
/// a cart with friction on a slider, a clapper on a damped ball joint, and a wheel that follows the cart.
inline std::vector<core::BodyId> place_machine(core::Scene& scene, double x) {
  const std::uint64_t first = scene.bodies.size();
  core::HingeJoint endless{core::JointLimits{-std::numeric_limits<double>::infinity(), 60}, {}};
  endless.drive = core::JointDrive{.speed = 15, .damping = 0.5, .max_effort = 2};
  core::HingeJoint stiff;
  stiff.drive = core::JointDrive{.position = 9, .stiffness = 2000, .damping = 20, .max_effort = 5};
  core::SliderJoint cart;
  cart.resistance = {.stiffness = 40, .rest = 0.3, .damping = 0.2, .friction = 1};
  core::HingeJoint follower;
  follower.drive = core::JointDrive{.stiffness = 5000, .damping = 50, .max_effort = 20};
  follower.follows = core::JointCoupling{core::JointId{static_cast<std::uint32_t>(scene.joints.size()) + 2}, 3};
  const core::JointKind kinds[] = {endless, stiff, cart, core::BallJoint{0.05}, follower};
  place_body(scene, kBox, {x, 0, 3});
  for (std::size_t i = 0; i < 5; ++i) {
    const double angle = 1.25 * static_cast<double>(i);
    const core::Vec3 outward(std::cos(angle), std::sin(angle), 0.2);
    place_body(scene, static_cast<int>(i) % 3, core::Vec3(x, 0, 3) + outward);
    add_joint(scene, kinds[i], scene.bodies.size() - 1, first, core::Vec3(x, 0, 3) + 0.5 * outward,
              outward.normalized());
  }
  std::vector<core::BodyId> ids;
  for (std::uint64_t id = first; id < scene.bodies.size(); ++id) ids.push_back(core::BodyId{id});
  return ids;
}

/// Piles of all shapes with joints in them, which come to rest, some of them next to each other.
inline std::vector<core::BodyRecord> piles_of_all_shapes(core::Scene& scene, std::mt19937_64& random) {
  for (int i = 0; i < 60; ++i) {
    const core::Vec3 p(3 * (i % 5) + uniform(random, -1, 1), 3 * (i / 5 % 3) + uniform(random, -1, 1), 1 + i / 5);
    place_body(scene, i % kKinds, p);
    const auto id = static_cast<std::uint64_t>(i);
    if (i % 12 == 11) add_joint(scene, core::BallJoint{}, id - 5, id, p - core::Vec3(0.5, 0, 0));
  }
  return initial_records(scene);
}

}  // namespace aurasim::physics::testing
