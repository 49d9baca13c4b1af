// Bodies and joints for scenes, one by one.
#pragma once

#include <optional>
#include <utility>

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

}  // namespace aurasim::physics::testing
