// How a run is started, steered and watched over DDS: topics node_status, region_map, run_control.
// For nodes, the launcher and the tools alike.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/region_map.h"
#include "dds/participant.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

enum class NodeState : std::uint8_t { kStarting, kWaiting, kRunning, kPaused, kFinished, kFailed };
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

/// What a node says of itself.
struct Status {
  core::RegionId region{};
  core::Generation generation = 0;
  core::Step step = 0;
  std::uint32_t pid = 0;
  std::uint64_t map_version = 0;
  std::uint64_t agreement = 0;  ///< equal on all nodes of a run (config::Launch::agreement)
  NodeState state = NodeState::kStarting;
  std::uint64_t bodies = 0;
  std::uint64_t awake = 0;
  std::uint64_t foreign_auras = 0;
  std::uint64_t hand_offs_out = 0;
  std::uint64_t hand_offs_in = 0;
  Violations violations;
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
  std::vector<std::uint64_t> meshes;  ///< hashes of clients' meshes that it has
};

/// The last status of one region, and whether its node is still there.
struct SeenStatus {
  Status status;
  bool lost = false;  ///< its proof of life has ended; false again when it comes back
  std::chrono::steady_clock::time_point seen;

  /// Neither lost nor at its end.
  bool is_live() const { return !lost && status.state != NodeState::kFinished && status.state != NodeState::kFailed; }
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

enum class RunCommandKind : std::uint8_t { kStart, kPause, kResume, kStep, kReset, kStop };
const char* name_of(RunCommandKind kind);

struct RunCommand {
  std::uint64_t request = 0;  ///< 0: send() draws one
  RunCommandKind kind = RunCommandKind::kStart;
  core::Generation generation = 0;
  std::uint64_t map_version = 0;  ///< of the run that is meant; 0: any
  core::Step at_step = 0;         ///< takes effect when this state has been computed
  std::int64_t count = 0;         ///< kStep: how many steps
  std::int64_t epoch_ns = 0;      ///< wall clock (since 1970) of step 0; for kResume: of the first step after it
};

struct ControlSettings {
  /// Commands for another map are refused and counted; statuses and maps of all runs are seen. Nothing: all commands.
  std::optional<std::uint64_t> map_version;
  /// This process is the node of this region and may publish_status. Nothing: launcher or tool.
  std::optional<core::RegionId> region;
};

/// Used by one thread. The participant must outlive it.
class ControlBus {
 public:
  ControlBus(Participant& participant, const ControlSettings& settings);
  ~ControlBus();

  /// Only with a region. False when the write failed twice.
  bool publish_status(const Status& status);
  /// The latest status of every region seen so far (also this one's).
  const std::map<core::RegionId, SeenStatus>& statuses();

  bool publish_map(const WorldMap& map);
  /// Commands for another map than this one are refused from now on.
  void use_map(std::uint64_t map_version);
  /// Every map seen so far, by map_version.
  const std::map<std::uint64_t, WorldMap>& maps();

  /// Returns the request id. Late joiners get it too, as long as the sender lives. Throws DdsError when the write
  /// failed twice.
  std::uint64_t send(RunCommand command);
  /// Commands of others that were not returned before, in order of arrival; each request id once.
  std::vector<RunCommand> take_commands();

  /// Returns when something arrived or a node's proof of life changed, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

  /// How many other processes listen to run_control. A command sent to nobody still reaches late joiners.
  std::size_t listeners() const;

  const WireErrors& refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
