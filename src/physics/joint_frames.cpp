#include "physics/joint_frames.h"

#include <stdexcept>
#include <string>

namespace aurasim::physics {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

Pose frame_in(const Pose& X_WB, const Pose& X_WJ) {
  const Quat q_BW = X_WB.q_WB.normalized().conjugate();
  return {q_BW * (X_WJ.p_WB - X_WB.p_WB), q_BW * X_WJ.q_WB.normalized()};
}

const core::InitialBody& body_of(const core::JointSpec& joint, core::BodyId id, const core::Scene& scene) {
  if (const core::InitialBody* body = core::find_body(scene, id)) return *body;
  throw std::invalid_argument("joint \"" + joint.name + "\" binds body " + std::to_string(core::value_of(id)) +
                              ", which is not there in state 0");
}

}  // namespace

JointFrames frames_of(const core::JointSpec& joint, const core::Scene& scene, const Vec3& p_WO) {
  if (joint.b == joint.a) throw std::invalid_argument("joint \"" + joint.name + "\" binds a body to itself");
  const Pose X_WB = joint.b ? body_of(joint, *joint.b, scene).pose : Pose{p_WO, Quat::Identity()};
  return {frame_in(body_of(joint, joint.a, scene).pose, joint.X_WJ), frame_in(X_WB, joint.X_WJ)};
}

}  // namespace aurasim::physics
