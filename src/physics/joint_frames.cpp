#include "physics/joint_frames.h"

#include <stdexcept>
#include <string>

namespace aurasim::physics {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

const core::InitialBody& body_of(const core::JointSpec& joint, core::BodyId id, const core::Scene& scene) {
  if (const core::InitialBody* body = core::find_body(scene, id)) return *body;
  throw std::invalid_argument("joint \"" + joint.name + "\" binds body " + std::to_string(core::value_of(id)) +
                              ", which is not there in state 0");
}

}  // namespace

core::JointFrame frames_of(const core::JointSpec& joint, const core::Scene& scene) {
  if (joint.b == joint.a) throw std::invalid_argument("joint \"" + joint.name + "\" binds a body to itself");
  const Pose X_WB = joint.b ? body_of(joint, *joint.b, scene).pose : Pose{Vec3::Zero(), Quat::Identity()};
  return core::frame_of(joint, body_of(joint, joint.a, scene).pose, X_WB);
}

}  // namespace aurasim::physics
