// Topics of ROS 2: a node publishes its bodies, and receives where they should drive (docs/ros2.md). Uses a participant
// of its own, in ROS's domain and without partitions, so ROS participants have no access to the run except through this
// bus.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/body_state.h"
#include "dds/settings.h"

namespace aurasim::dds {

struct Ros2Settings {
  Settings dds;                      ///< with ROS's domain; without keys, which ROS's own participants do not have
  std::string frame = "world";       ///< parent of all frames
  std::vector<std::string> cmd_vel;  ///< names of bodies that accept /NAME/cmd_vel
};

/// Simulated time since state 0.
using Ros2Time = std::chrono::nanoseconds;

struct Ros2Transform {
  std::string child;
  core::Pose pose;
};

/// One row for each joint.
struct Ros2Joints {
  std::vector<std::string> name;
  std::vector<double> position;  ///< rad or m
  std::vector<double> velocity;  ///< rad/s or m/s
};

/// Velocity command, in the frame of the body that is to drive.
struct Ros2Twist {
  std::size_t listener = 0;                 ///< place in Ros2Settings::cmd_vel
  std::uint64_t sender = 0;                 ///< the same number for the same publisher on all nodes; not 0
  std::uint64_t sequence = 0;               ///< counts the sender's messages: 1, 2, ...
  core::Vec3 linear = core::Vec3::Zero();   ///< m/s
  core::Vec3 angular = core::Vec3::Zero();  ///< rad/s
};

/// Used by one thread. Never waits for a subscriber.
class Ros2Bus {
 public:
  /// Joins ROS's domain. Throws DdsError as Participant does.
  explicit Ros2Bus(const Ros2Settings& settings);
  ~Ros2Bus();

  // Whether a topic has subscribers. Without any, its messages need not be composed.
  bool wants_clock() const;
  bool wants_tf() const;
  bool wants_joints() const;
  /// Counts subscribers that have joined so far.
  std::uint64_t arrivals() const;

  void say_clock(Ros2Time now);
  /// Publishes transforms on /tf, in several messages if there are many.
  void say_tf(Ros2Time now, std::span<const Ros2Transform> transforms);
  void say_joints(Ros2Time now, const Ros2Joints& joints);

  /// Returns the commands that arrived since the last call. Non-finite ones are dropped and counted.
  std::vector<Ros2Twist> take();
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
