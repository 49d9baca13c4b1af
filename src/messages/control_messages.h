// Messages of topics node_status, region_map and run_control.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "core/introduction.h"
#include "core/region_map.h"
#include "core/setpoint.h"

namespace aurasim::messages {

enum class NodeState : std::uint8_t {
  kStarting,
  kWaiting,
  kRunning,
  kPaused,
  kFinished,
  kFailed,
  kRecovering,  ///< stopped because a node has died, until all nodes go back to a kept state
  kSpare,       ///< a spare process without a world: can take over a region
  kCutOff,      ///< stopped, because it receives from too few of the others to go on with them
};
const char* name_of(NodeState state);

/// How bodies of two regions touch in this run (config::Exchange).
enum class ExchangeInUse : std::uint8_t { kNotChosen, kAura, kCoupled };
const char* name_of(ExchangeInUse exchange);

/// Durations over the last second, milliseconds.
struct Durations {
  double p50_ms = 0;
  double p99_ms = 0;
  double max_ms = 0;
};

/// Violations since the start, by kind.
struct Violations {
  std::uint64_t speed = 0;    ///< a body was faster than tolerances.speed
  std::uint64_t latency = 0;  ///< a message was older than K steps when it was needed
  std::uint64_t frame = 0;    ///< a frame took longer than tolerances.frame
  std::uint64_t promise = 0;  ///< a body left what its last aura promised
  std::uint64_t span = 0;     ///< a cluster or reach wider than the neighbours that were asked

  /// Names and numbers of all kinds.
  std::array<std::pair<const char*, std::uint64_t>, 5> by_kind() const {
    return {{{"speed", speed}, {"latency", latency}, {"frame", frame}, {"promise", promise}, {"span", span}}};
  }
  std::uint64_t total() const { return speed + latency + frame + promise + span; }
};

/// Names one kept part: a region's part of the world in one state.
struct KeptPart {
  core::RegionId region{};
  core::Step step = 0;
  auto operator<=>(const KeptPart&) const = default;
};

/// Region of a spare: a process that waits until some region needs one.
inline constexpr core::RegionId kNoRegion{0xf'ffff};

/// Status that a node publishes about itself.
struct Status {
  core::RegionId region{};
  core::Generation generation = 0;
  core::Step step = 0;
  std::uint64_t run = 0;  ///< number of the run; 0: its nodes were started by hand
  std::uint32_t pid = 0;
  std::uint64_t process = 0;  ///< random number
  std::uint64_t map_version = 0;
  std::uint64_t agreement = 0;  ///< equal on all nodes of a run (config::Launch::agreement)
  NodeState state = NodeState::kStarting;
  std::optional<core::Step> holds_at;  ///< state at which it is paused or will pause; nothing: it goes on
  /// Generation in which the scene began from its first state; parts of other eras do not fit.
  core::Generation era = 0;
  std::vector<KeptPart> parts;  ///< parts that this node keeps
  std::uint64_t bodies = 0;
  std::uint64_t awake = 0;
  std::uint64_t foreign_auras = 0;
  std::uint64_t hand_offs_out = 0;
  std::uint64_t hand_offs_in = 0;
  Violations violations;
  /// Late collisions since the start, as far as the node itself can see them (node/collision_watch.h).
  std::uint64_t late_collisions = 0;
  std::uint64_t missed_collisions = 0;  ///< missed collisions since the start, as far as the node itself can see them
  std::uint32_t redos = 0;              ///< how often this generation has been put back and computed again
  std::uint64_t setpoints_heard = 0;    ///< messages of programs received since the start
  std::uint64_t setpoints_late = 0;     ///< messages of programs that came after their state had been computed here
  /// Messages not understood, too many or too far ahead, and setpoints beyond what a body can bear.
  std::uint64_t setpoints_refused = 0;
  /// Regions whose messages it receives and that receive its messages, ascending.
  std::vector<core::Listened> listens_to;
  Durations frame;
  Durations physics;
  Durations protocol;
  Durations transport;
  Durations exchange_times;  ///< one exchange with the other regions where they are coupled, else 0
  ExchangeInUse exchange = ExchangeInUse::kNotChosen;
  /// Slowest round trip that this node has measured to another one before the start, ms; 0: it has measured none.
  double round_trip_ms = 0;
  double real_time_factor = 0;  ///< simulated seconds per second
  double rate = 1;              ///< requested simulated seconds per second
  std::uint64_t largest_cluster = 0;
  core::Rectangle footprint;  ///< the region; infinite sides allowed, metres
  std::int32_t lookahead = 0;
  std::string text;  ///< e.g. why it failed; cut at 256 bytes
  std::vector<core::RegionId> dead;
  std::vector<std::uint64_t> meshes;     ///< hashes of clients' meshes that it has
  std::vector<std::uint64_t> saved;      ///< the newest saves (cut::SavedWorld::save) whose part it has on disk
  std::vector<std::uint64_t> not_saved;  ///< the newest ones whose part it could not write
  std::vector<std::pair<core::RegionId, std::uint64_t>> refused;  ///< messages that it has refused, by source
};

/// The last status of one region, and whether its node is still there.
struct SeenStatus {
  Status status;
  bool lost = false;  ///< its proof of life has ended; false again when it comes back
  bool dead = false;  ///< it will not come back: the process that started it has seen it end
  std::chrono::steady_clock::time_point seen;
  /// Number of the host, which Fast DDS makes from its addresses; equal for processes on one host.
  std::uint16_t host = 0;
  /// How far the node's wall clock is ahead of the own one, estimated from its last statuses. A lower bound: it is too
  /// small by the transit time of the fastest of them.
  std::chrono::nanoseconds clock_ahead{0};

  bool has_ended() const { return status.state == NodeState::kFinished || status.state == NodeState::kFailed; }
  /// Live: neither lost, nor ended, nor cut off from the other nodes.
  bool is_live() const { return !lost && !has_ended() && status.state != NodeState::kCutOff; }
};

/// Region map: which region owns which rectangle. Published by the launcher or a node.
struct WorldMap {
  std::uint64_t map_version = 0;
  std::uint64_t agreement = 0;
  core::Generation generation = 0;
  core::Step from_step = 0;  ///< first state for which the map holds
  std::string scene;         ///< cut at 256 bytes
  std::vector<core::Rectangle> regions;
};

enum class RunCommandKind : std::uint8_t {
  kStart,
  kPause,
  kResume,
  kStep,
  kReset,
  kStop,
  kRate,
  kLost,
  kRestore,
  kDrain,
  kTake,
  kEnd
};
const char* name_of(RunCommandKind kind);

struct RunCommand {
  std::uint64_t request = 0;  ///< 0: send() draws one
  RunCommandKind kind = RunCommandKind::kStart;
  core::Generation generation = 0;
  std::uint64_t map_version = 0;  ///< map version of the run that is meant; 0: any
  std::uint64_t run = 0;          ///< number of the run that is meant; 0: any
  core::Step at_step = 0;         ///< takes effect when this state has been computed
  std::int64_t count = 0;         ///< kStep: how many steps, up to `at_step`
  /// KStep: the step waits until this message was received on topic control; number 0: no wait.
  core::ProgramWord after{};
  std::int64_t epoch_ns = 0;  ///< wall clock (ns since 1970) of step 0; for kResume and kStep: of the first step
  double rate = 1;            ///< kRate: simulated seconds per second from `at_step` on; `at_step` is due at `epoch_ns`
  /// kLost: the region whose node has died. kDrain: the region whose node is to hand it to another process. kTake: the
  /// region that a spare is to take over. kEnd: the region that no process takes over, so the run ends.
  core::RegionId region{};
  std::uint64_t process = 0;  ///< kLost, kDrain: the node's process; kTake: the spare's
  core::Generation era = 0;   ///< kRestore: `generation` begins with state `at_step` of this era, due at `epoch_ns`
  struct Member {
    std::uint64_t process = 0;  ///< process that continues the region
    core::RegionId holder{};    ///< region whose node publishes this region's part to all
    bool survives = false;      ///< this process lived before the death and knows the orders executed so far
  };
  std::vector<Member> members;  ///< kRestore: by region
  bool is_of_itself = false;  ///< kLost: sent by the very process that it names. Set by the receiver; not on the wire.
  /// Sent by a node, as far as is known; else by a launcher, an operator or anybody. Not on the wire.
  bool is_of_a_node = true;
  /// How far the sender's wall clock was ahead of the own one when the command came, less the transit time. Not on the
  /// wire.
  std::chrono::nanoseconds clock_ahead{0};
};

}  // namespace aurasim::messages
