#include "cli/ros2_view.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace aurasim::cli {
namespace {

/// X_WB^-1 X_WJ.
core::Pose seen_from(const core::Pose& X_WB, const core::Pose& X_WJ) {
  const core::Quat q_BW = X_WB.q_WB.conjugate();
  return {q_BW * (X_WJ.p_WB - X_WB.p_WB), q_BW * X_WJ.q_WB};
}

struct MovingFrame {
  core::Vec3 p_W, v_W, w_W;
  core::Mat3 R_W;
};

/// `body` null: the world.
MovingFrame moved(const core::Pose& X_BJ, const core::BodyState* body) {
  if (body == nullptr) return {X_BJ.p_WB, core::Vec3::Zero(), core::Vec3::Zero(), X_BJ.q_WB.toRotationMatrix()};
  const core::Vec3 arm_W = body->pose.q_WB * X_BJ.p_WB;
  return {body->pose.p_WB + arm_W, body->v_WB + body->w_WB.cross(arm_W), body->w_WB,
          (body->pose.q_WB * X_BJ.q_WB).toRotationMatrix()};
}

const core::BodyState* find(const core::Snapshot& snapshot, core::BodyId id) {
  const auto found = std::ranges::lower_bound(snapshot.bodies, id, {}, &core::BodyState::id);
  const bool is_there = found != snapshot.bodies.end() && found->id == id && found->birth <= snapshot.step;
  return is_there ? &*found : nullptr;
}

/// Pairs that joints hold together: one that is broken holds nothing.
class Held {
 public:
  explicit Held(const core::Snapshot& snapshot) : first_(snapshot.bodies.data()) {
    for (const core::Contact& pair : snapshot.joints) pairs_.emplace_back(pair.a, pair.b);
    std::ranges::sort(pairs_);
  }
  bool together(const core::BodyState& a, const core::BodyState& b) const {
    const std::pair pair(static_cast<std::uint32_t>(&a - first_), static_cast<std::uint32_t>(&b - first_));
    return std::ranges::binary_search(pairs_,
                                      std::pair(std::min(pair.first, pair.second), std::max(pair.first, pair.second)));
  }

 private:
  const core::BodyState* first_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

}  // namespace

dds::Ros2Time ros2_time(core::Step step, double step_hz) {
  const auto whole_s = static_cast<core::Step>(std::floor(static_cast<double>(step) / step_hz));
  const double rest_steps = static_cast<double>(step) - static_cast<double>(whole_s) * step_hz;
  return std::chrono::seconds(whole_s) + dds::Ros2Time(std::llround(1e9 * rest_steps / step_hz));
}

FrameNames::FrameNames(const config::Launch& launch) {
  for (std::size_t i = 0; i < launch.body_sources.size() && i < launch.scene.bodies.size(); ++i) {
    const std::string& name = launch.body_sources[i].name;
    if (name.empty()) continue;
    names_.emplace(launch.scene.bodies[i].id, name);
    ids_.emplace(name, launch.scene.bodies[i].id);
  }
}

std::string FrameNames::of(core::BodyId id) const {
  const auto name = names_.find(id);
  return name != names_.end() ? name->second : fmt::format("body_{}", core::value_of(id));
}

std::optional<core::BodyId> FrameNames::body(const std::string& name) const {
  const auto id = ids_.find(name);
  return id != ids_.end() ? std::optional(id->second) : std::nullopt;
}

std::optional<JointMotion> motion_of(const core::JointKind& kind, const core::Pose& X_AJ, const core::BodyState& a,
                                     const core::Pose& X_BJ, const core::BodyState* b) {
  const MovingFrame of_a = moved(X_AJ, &a), of_b = moved(X_BJ, b);
  const core::Vec3 axis_W = of_b.R_W.col(2);
  if (std::holds_alternative<core::HingeJoint>(kind)) {
    const core::Mat3 R_ba = of_b.R_W.transpose() * of_a.R_W;
    return JointMotion{std::atan2(R_ba(1, 0) - R_ba(0, 1), R_ba(0, 0) + R_ba(1, 1)), axis_W.dot(of_a.w_W - of_b.w_W)};
  }
  if (std::holds_alternative<core::SliderJoint>(kind)) {
    const core::Vec3 way_W = of_a.p_W - of_b.p_W;
    return JointMotion{axis_W.dot(way_W), axis_W.dot(of_a.v_W - of_b.v_W - of_b.w_W.cross(way_W))};
  }
  return std::nullopt;
}

JointRows::JointRows(const core::Scene& scene) {
  for (const core::JointSpec& joint : scene.joints) {
    const bool moves_one_way =
        std::holds_alternative<core::HingeJoint>(joint.kind) || std::holds_alternative<core::SliderJoint>(joint.kind);
    const core::InitialBody* const a = core::find_body(scene, joint.a);
    const core::InitialBody* const b = joint.b ? core::find_body(scene, *joint.b) : nullptr;
    if (!moves_one_way || a == nullptr || (joint.b && b == nullptr)) continue;
    rows_.push_back({joint, seen_from(a->pose, joint.X_WJ), b ? seen_from(b->pose, joint.X_WJ) : joint.X_WJ});
  }
}

dds::Ros2Joints JointRows::in(const core::Snapshot& snapshot) const {
  dds::Ros2Joints joints;
  const Held held(snapshot);
  for (const Row& row : rows_) {
    const core::BodyState* const a = find(snapshot, row.joint.a);
    const core::BodyState* const b = row.joint.b ? find(snapshot, *row.joint.b) : nullptr;
    if (a == nullptr || (row.joint.b && (b == nullptr || !held.together(*a, *b)))) continue;
    const auto motion = motion_of(row.joint.kind, row.X_AJ, *a, row.X_BJ, b);
    if (!motion) continue;
    joints.name.push_back(row.joint.name);
    joints.position.push_back(motion->position);
    joints.velocity.push_back(motion->velocity);
  }
  return joints;
}

}  // namespace aurasim::cli
