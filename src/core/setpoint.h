// What a program wants of bodies and joints from a state on, until it says otherwise
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

/// Of a body, in the world's frame but for the last.
enum class Quantity : std::uint8_t {
  kForce,     ///< N, at the centre of mass
  kTorque,    ///< N m
  kVelocity,  ///< m/s: the body has it before each state is computed
  kSpin,      ///< rad/s: likewise
  /// Likewise, of a mobile base: m/s ahead and to the left, rad/s about the vertical; ahead is where the body's x axis
  /// points on the ground (docs/ros2.md). How it rises, falls and tilts is left to gravity and contacts.
  kDriving,
};
inline constexpr int kQuantities = 5;

/// What can be told by itself.
using BodyKey = std::pair<BodyId, Quantity>;

struct BodySetpoint {
  BodyId id{};
  Quantity quantity{};
  std::optional<Vec3> value;  ///< nothing: lets go of it
};

struct JointSetpoint {
  JointId id{};
  std::optional<JointDrive> drive;  ///< nothing: the joint has the scene's own again
};

/// Where a static goes: evenly, from where it is in the state before, and then it stays there.
struct StaticSetpoint {
  StaticId id{};
  Pose to;
  Step states = 1;  ///< until it is there: 1: in the first state that shows the effect
};

/// All that one program says for one state. Without entries: it is still there, and what it has said goes on.
struct Setpoints {
  std::uint64_t client = 0;    ///< random number of the program; kRecordedClient: it is read from a record
  std::uint64_t sequence = 0;  ///< 1, 2, ...: of two for one state the later one counts
  Generation generation = 0;
  Step at_step = 0;  ///< the first state that shows the effect; 0: as soon as all can know of it in time
  std::vector<BodySetpoint> bodies;
  std::vector<JointSetpoint> joints;
  std::vector<StaticSetpoint> statics = {};
};

/// A message of one program on topic control, by its number.
struct ProgramWord {
  std::uint64_t program = 0;  ///< Setpoints::client
  std::uint64_t number = 0;   ///< Setpoints::sequence; 0: no message

  bool operator==(const ProgramWord&) const = default;
};

/// Never falls silent.
inline constexpr std::uint64_t kRecordedClient = 0;

/// What has been in effect on a body or joint from a state on, where it was hosted.
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

/// For a state that has been computed already.
enum class LateSetpoint : std::uint8_t { kNextState, kDropped };

/// What becomes of the setpoints of a program that says nothing any more.
enum class OnSilence : std::uint8_t {
  kHold,  ///< stop: no force, torque or effort, no speed; drives keep their positions
  kZero,  ///< let go of everything
  kLast,  ///< as if it went on
};

/// What all nodes of a run agree on about setpoints.
struct ControlRules {
  LateSetpoint late = LateSetpoint::kNextState;
  OnSilence on_silence = OnSilence::kHold;
  Step silence = 30;  ///< states without a word of it after which a program has fallen silent
};

}  // namespace aurasim::core
