// Setpoints: values that a program sets for bodies and joints from a state on, until its next message about them
// (docs/decisions/0026-setpoints.md).
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/joint.h"

namespace aurasim::core {

/// Quantities of a body that programs can set, in the world's frame except kDriving.
enum class Quantity : std::uint8_t {
  kForce,     ///< N, at the centre of mass
  kTorque,    ///< N m
  kVelocity,  ///< m/s; set before each state is computed
  kSpin,      ///< rad/s; set before each state is computed
  /// Velocity of a mobile base, set before each state is computed: m/s ahead, m/s to the left, rad/s about the
  /// vertical. Ahead is the body's x axis projected on the ground (docs/ros2.md). Gravity and contacts decide how it
  /// rises, falls and tilts.
  kDriving,
};
inline constexpr int kQuantities = 5;

/// The smallest unit of a body setpoint: one quantity of one body.
using BodyKey = std::pair<BodyId, Quantity>;

struct BodySetpoint {
  BodyId id{};
  Quantity quantity{};
  std::optional<Vec3> value;  ///< nothing: the setpoint ends
};

struct JointSetpoint {
  JointId id{};
  std::optional<JointDrive> drive;  ///< nothing: the joint gets its drive of the scene back
};

/// Moves a static evenly from its pose in the state before to `to`, where it stays.
struct StaticSetpoint {
  StaticId id{};
  Pose to;
  Step states = 1;  ///< number of states until it is at `to`; 1: it is there in the first state that shows the effect
};

/// One message of a program, for one state. Without entries it only shows that the program is alive, and its setpoints
/// stay in effect.
struct Setpoints {
  std::uint64_t client = 0;    ///< random number of the program; kRecordedClient: read from a record
  std::uint64_t sequence = 0;  ///< 1, 2, ...; of two messages for one state the one with the higher number counts
  Generation generation = 0;
  Step at_step = 0;  ///< the first state that shows the effect; 0: as soon as all nodes can receive it in time
  std::vector<BodySetpoint> bodies;
  std::vector<JointSetpoint> joints;
  std::vector<StaticSetpoint> statics = {};
};

/// Identifies a message of one program on topic control.
struct ProgramWord {
  std::uint64_t program = 0;  ///< Setpoints::client
  std::uint64_t number = 0;   ///< Setpoints::sequence; 0: no message

  bool operator==(const ProgramWord&) const = default;
};

/// Setpoints::client of recorded messages. It never counts as silent.
inline constexpr std::uint64_t kRecordedClient = 0;

/// A setpoint that took effect in state `step`, as noted by the host of its body or joint.
struct BodyEffect {
  Step step = 0;
  BodySetpoint setpoint;
};
struct JointEffect {
  Step step = 0;
  JointSetpoint setpoint;
};

struct StaticEffect {
  Step step = 0;
  StaticSetpoint setpoint;
};

/// Use of a setpoint for a state that has been computed already.
enum class LateSetpoint : std::uint8_t { kNextState, kDropped };

/// Use of the setpoints of a program that sends no messages any more.
enum class OnSilence : std::uint8_t {
  kHold,  ///< stop: force, torque, effort and speed become 0; drives keep their positions
  kZero,  ///< all its setpoints end
  kLast,  ///< all its setpoints stay in effect
};

/// Rules for setpoints. All nodes of a run have to have the same.
struct ControlRules {
  LateSetpoint late = LateSetpoint::kNextState;
  OnSilence on_silence = OnSilence::kHold;
  Step silence = 30;  ///< a program counts as silent after so many states without a message
};

}  // namespace aurasim::core
