#include "process/ros2_view.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace aurasim::process {
namespace {

/// The body `id` of a snapshot. Null if it is not there, or not born yet.
const core::BodyState* find(const core::Snapshot& snapshot, core::BodyId id) {
  const core::BodyState* const body = core::find_body(snapshot.bodies, id);
  return body != nullptr && body->birth <= snapshot.step ? body : nullptr;
}

/// The pairs of bodies that joints hold together. Broken joints are left out.
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

JointRows::JointRows(const core::Scene& scene) {
  for (const core::JointSpec& joint : scene.joints) {
    const bool moves_one_way =
        std::holds_alternative<core::HingeJoint>(joint.kind) || std::holds_alternative<core::SliderJoint>(joint.kind);
    const core::InitialBody* const a = core::find_body(scene, joint.a);
    const core::InitialBody* const b = joint.b ? core::find_body(scene, *joint.b) : nullptr;
    if (!moves_one_way || a == nullptr || (joint.b && b == nullptr)) continue;
    rows_.push_back({joint, core::frame_of(joint, a->pose, b ? b->pose : core::Pose{}), *core::coordinate_of(joint)});
  }
}

dds::Ros2Joints JointRows::in(const core::Snapshot& snapshot) const {
  dds::Ros2Joints joints;
  const Held held(snapshot);
  for (const Row& row : rows_) {
    const core::BodyState* const a = find(snapshot, row.joint.a);
    const core::BodyState* const b = row.joint.b ? find(snapshot, *row.joint.b) : nullptr;
    if (a == nullptr || (row.joint.b && (b == nullptr || !held.together(*a, *b)))) continue;
    const core::JointMotion motion = core::joint_motion(row.frame, row.coordinate, *a, b ? *b : core::BodyState{});
    joints.name.push_back(row.joint.name);
    joints.position.push_back(motion.position);
    joints.velocity.push_back(motion.speed);
  }
  return joints;
}

}  // namespace aurasim::process
