// Sensors of a client that look at a merged state: ray fans and triggers, fixed in the world or on a body. No clock, no
// wire.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "agent/merged_states.h"
#include "core/interest.h"
#include "physics/ray_scene.h"

namespace aurasim::agent {

/// Where a sensor is: its pose in the frame of its carrier, or in the world.
struct Mount {
  std::optional<core::BodyId> carrier;
  core::Pose X_CS;

  /// Pose in the world. Nothing if the carrier is not among `bodies`.
  std::optional<core::Pose> pose_in(const std::vector<WorldBody>& bodies) const;
};

struct FanSpec {
  Mount mount;
  std::vector<core::Vec3> directions;  ///< in S, of length 1
  double range_m = 0;
  core::Step every = 1;  ///< cast in states whose number is a multiple of this
};

/// A box around the origin of S with its sides along the axes of S, or a ball.
struct TriggerSpec {
  Mount mount;
  core::Vec3 half_extents = core::Vec3::Zero();
  double radius_m = 0;  ///< > 0: a ball

  double reach_m() const { return radius_m > 0 ? radius_m : half_extents.norm(); }
  bool holds(const core::Pose& X_WS, const core::Vec3& p_WB) const;
};

struct FanResult {
  bool was_cast = false;
  bool complete = false;  ///< all bodies that its rays could hit were known
  std::vector<physics::RayHit> hits;
};

struct TriggerResult {
  bool complete = false;
  std::vector<core::BodyId> inside, entered, left;  ///< ascending
};

/// Finds the bodies whose origins are in a trigger, and those that have entered or left it since the state before. A
/// carrier is never in its own trigger.
class Trigger {
 public:
  explicit Trigger(TriggerSpec spec) : spec_(std::move(spec)) {}
  const TriggerSpec& spec() const { return spec_; }

  TriggerResult look(const std::vector<WorldBody>& bodies);

 private:
  TriggerSpec spec_;
  std::vector<core::BodyId> inside_;
};

/// The part of the world that a sensor has to know, and the interest that asked for it. It follows the sensor's carrier
/// at intervals, with a margin so that it is seldom too late.
class Surroundings {
 public:
  /// `reach_m`: radius around the sensor, metres.
  Surroundings(Mount mount, double reach_m);

  /// Moves the box that is asked for, if the sensor has left the margin. True if a new interest has to be sent.
  bool follow(const core::Vec3& p_WS, double reach_m);
  /// The box that is asked for now. Nothing while the carrier's place is unknown.
  std::optional<core::WorldBox> box() const;
  /// Notes that the interest `sequence` has asked for the present box.
  void note(std::uint64_t sequence);
  /// True if the interest `sequence` asked for all that is around the sensor.
  bool was_asked_for(std::uint64_t sequence, const core::Vec3& p_WS) const;
  const Mount& mount() const { return mount_; }
  double reach_m() const { return reach_m_; }

 private:
  struct Asked {
    std::uint64_t sequence = 0;
    core::Vec3 p_W = core::Vec3::Zero();
    double reach_m = 0;  ///< with the margin
  };

  double margin_m() const;

  Mount mount_;
  double reach_m_;
  std::optional<Asked> now_;
  std::vector<Asked> asked_;  ///< ascending sequence
};

}  // namespace aurasim::agent
