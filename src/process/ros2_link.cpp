#include "process/ros2_link.h"

#include <algorithm>
#include <utility>

#include "node/replica_feed.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

/// A ROS 2 reader that this node has discovered may not have discovered this node yet. In a paused run the state is
/// published to it once more after these times.
constexpr auto kUntilKnown = std::chrono::milliseconds(300), kUntilSentAgain = std::chrono::milliseconds(1000);

dds::Ros2Settings ros2_settings(const config::Launch& launch, core::RegionId region) {
  dds::Ros2Settings settings;
  settings.dds = setup::dds_settings(launch, region);
  settings.dds.domain = static_cast<std::uint32_t>(launch.ros2.domain.value_or(launch.dds.domain));
  settings.frame = launch.ros2.frame;
  settings.cmd_vel = launch.ros2.cmd_vel;
  return settings;
}

}  // namespace

Ros2Link::Ros2Link(const config::Launch& launch, core::RegionId region)
    : launch_(launch),
      bus_(ros2_settings(launch, region)),
      tick_steps_(node::tick_steps(launch.time.step_hz, launch.ros2.tf_hz)) {}

void Ros2Link::begin(core::Generation generation) {
  generation_ = generation;
  names_.emplace(launch_);
  joints_.emplace(launch_.scene);
  next_ = 0;
  published_ = -1;
  held_.clear();
}

void Ros2Link::put_back(core::Step step, core::Step confirmed) {
  held_.put_back(step, confirmed);
  next_ = std::min(next_, (std::max(published_, step) / tick_steps_ + 1) * tick_steps_);
}

/// True if state `step` is to be published. No state is published twice, because ROS's time would go back.
bool Ros2Link::is_due(core::Step step) {
  const Clock::time_point now = Clock::now();
  const std::uint64_t arrivals = bus_.arrivals();
  if (std::exchange(arrivals_, arrivals) != arrivals) somebody_came_at_ = now;
  if (step >= next_) {
    next_ = (step / tick_steps_ + 1) * tick_steps_;
    if (somebody_came_at_ && now >= *somebody_came_at_ + kUntilKnown) somebody_came_at_.reset();
    return true;
  }
  const bool again = somebody_came_at_ && now >= *somebody_came_at_ + kUntilSentAgain && step + tick_steps_ >= next_;
  if (again) somebody_came_at_.reset();
  return again;
}

void Ros2Link::publish(node::Node& node, core::Generation generation, bool leads) {
  if (generation_ != generation) begin(generation);
  held_.give_out(node.shown_step());
  if (!is_due(node.current_step())) return;
  const core::Step step = node.current_step();
  const dds::Ros2Time now = ros2_time(step, launch_.time.step_hz);
  const bool wants_joints = !joints_->empty() && bus_.wants_joints();
  const core::Snapshot& snapshot = node.world().snapshot();
  std::vector<dds::Ros2Transform> transforms;
  if (bus_.wants_tf()) transforms = transforms_of(snapshot);
  dds::Ros2Joints joints;
  if (wants_joints) joints = joints_->in(snapshot);
  held_.add(step, [this, step, now, leads, transforms = std::move(transforms), joints = std::move(joints)] {
    published_ = step;
    if (leads && bus_.wants_clock()) bus_.say_clock(now);
    if (bus_.wants_tf()) bus_.say_tf(now, transforms);
    if (!joints.name.empty()) bus_.say_joints(now, joints);
  });
  held_.give_out(node.shown_step());
}

std::vector<dds::Ros2Transform> Ros2Link::transforms_of(const core::Snapshot& snapshot) const {
  std::vector<dds::Ros2Transform> transforms;
  for (const core::BodyState& body : snapshot.bodies) {
    if (body.birth <= snapshot.step) transforms.push_back({names_->of(body.id), body.pose});
  }
  return transforms;
}

std::vector<core::Setpoints> Ros2Link::take(core::Generation generation) {
  if (generation_ != generation) begin(generation);
  std::vector<core::Setpoints> taken;
  for (const dds::Ros2Twist& twist : bus_.take()) {
    const auto body = names_->body(launch_.ros2.cmd_vel.at(twist.listener));
    if (!body) continue;
    core::Setpoints& setpoints = taken.emplace_back();
    setpoints.client = twist.sender;
    setpoints.sequence = twist.sequence;
    setpoints.generation = generation;
    const core::Vec3 driving(twist.linear.x(), twist.linear.y(), twist.angular.z());
    setpoints.bodies.push_back({*body, core::Quantity::kDriving, driving});
  }
  return taken;
}

}  // namespace aurasim::process
