// What node_status, region_map and run_control say.
#pragma once

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

namespace aurasim::dds {

enum class NodeState : std::uint8_t {
  kStarting,
  kWaiting,
  kRunning,
  kPaused,
  kFinished,
  kFailed,
  kRecovering,  ///< stands, because a node has died, until all go back to a state that is kept
  kSpare,       ///< has no world yet: takes a region over
  kCutOff,      ///< stands, and hears too few of the others to go on with them
};
const char* name_of(NodeState state);

/// Of the last second, milliseconds.
struct Durations {
  double p50_ms = 0;
  double p99_ms = 0;
  double max_ms = 0;
};

/// Broken promises since the start, by kind.
struct Violations {
  std::uint64_t speed = 0;    ///< a body was faster than tolerances.speed
  std::uint64_t latency = 0;  ///< a message was older than K steps when it was needed
  std::uint64_t frame = 0;    ///< a frame took longer than tolerances.frame
  std::uint64_t promise = 0;  ///< a body left what its last aura promised
  std::uint64_t span = 0;     ///< a cluster or reach wider than the neighbours that were asked
};

/// A region's part of the world in one state.
struct KeptPart {
  core::RegionId region{};
  core::Step step = 0;
  auto operator<=>(const KeptPart&) const = default;
};

/// Of a process that waits until some region needs one.
inline constexpr core::RegionId kNoRegion{0xf'ffff};

/// What a node says of itself.
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
  std::optional<core::Step> holds_at;  ///< where it stands, or is to stand; nothing: it goes on
  core::Generation era = 0;            ///< in which the scene was begun from its first state: others' parts do not fit
  std::vector<KeptPart> parts;         ///< that it keeps
  std::uint64_t bodies = 0;
  std::uint64_t awake = 0;
  std::uint64_t foreign_auras = 0;
  std::uint64_t hand_offs_out = 0;
  std::uint64_t hand_offs_in = 0;
  Violations violations;
  std::uint64_t late_collisions = 0;    ///< since the start, as the node itself can see them (node/collision_watch.h)
  std::uint64_t missed_collisions = 0;  ///< likewise
  std::uint32_t redos = 0;              ///< how often this generation has been put back and computed again
  std::uint64_t setpoints_heard = 0;    ///< since the start: messages of programs
  std::uint64_t setpoints_late = 0;     ///< that came after their state had been computed here
  std::uint64_t setpoints_refused = 0;  ///< not understood, too many, too far ahead; and what a body cannot bear
  std::vector<core::Listened> listens_to;  ///< and they to it, by region
  Durations frame;
  Durations physics;
  Durations protocol;
  Durations transport;
  double real_time_factor = 0;  ///< simulated seconds per second
  double rate = 1;              ///< the same, as asked for
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
  bool dead = false;  ///< and it never will: whoever started it has seen it end
  std::chrono::steady_clock::time_point seen;
  std::uint16_t host = 0;  ///< the same for processes on one host, as Fast DDS makes it from the host's addresses
  /// How far its host's wall clock is ahead of ours, as far as its last statuses tell: never more than that, and less
  /// by the time that the fastest of them has taken.
  std::chrono::nanoseconds clock_ahead{0};

  bool has_ended() const { return status.state == NodeState::kFinished || status.state == NodeState::kFailed; }
  /// Neither lost nor at its end, nor out of reach of the others' words.
  bool is_live() const { return !lost && !has_ended() && status.state != NodeState::kCutOff; }
};

/// Who owns what, as the launcher or a node announces it.
struct WorldMap {
  std::uint64_t map_version = 0;
  std::uint64_t agreement = 0;
  core::Generation generation = 0;
  core::Step from_step = 0;  ///< holds from this state on
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
  std::uint64_t map_version = 0;  ///< of the run that is meant; 0: any
  std::uint64_t run = 0;          ///< likewise
  core::Step at_step = 0;         ///< takes effect when this state has been computed
  std::int64_t count = 0;         ///< kStep: how many steps, up to `at_step`
  core::ProgramWord after{};      ///< kStep: computed once this has been heard on topic control; number 0: at once
  std::int64_t epoch_ns = 0;      ///< wall clock (since 1970) of step 0; for kResume and kStep: of the first one
  double rate = 1;  ///< kRate: from `at_step` on, which is due at `epoch_ns`, simulated seconds per second
  /// kLost: whose node has died; kDrain: whose node is to give its region to another process; kTake: what a spare is to
  /// take over; kEnd: the run ends, because nobody takes this region over.
  core::RegionId region{};
  std::uint64_t process = 0;  ///< likewise: that node's, or the spare's
  core::Generation era = 0;   ///< kRestore: `generation` begins with state `at_step` of this era, due at `epoch_ns`
  struct Member {
    std::uint64_t process = 0;  ///< that goes on with the region
    core::RegionId holder{};    ///< whose node gives the region's part to all
    bool survives = false;      ///< it knows which orders there have been
  };
  std::vector<Member> members;  ///< kRestore: by region
  bool is_of_itself = false;    ///< kLost: that very process says so. Not sent.
  bool is_of_a_node = true;     ///< as far as is known; else it is a launcher's, an operator's, or anybody's. Not sent.
  /// How far the sender's wall clock was ahead of ours when it came, less its way. Not sent.
  std::chrono::nanoseconds clock_ahead{0};
};

}  // namespace aurasim::dds
