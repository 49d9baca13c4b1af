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

#include "dds/control_messages.h"
#include "dds/participant.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

struct ControlSettings {
  /// Commands for another map are refused and counted; maps of all runs are seen. Nothing: all commands.
  std::optional<std::uint64_t> map_version = {};
  /// This process is the node of this region and may publish_status. Nothing: launcher or tool.
  std::optional<core::RegionId> region = {};
  /// Whoever has another one in its status is a stranger. Nothing: whatever nodes are there.
  std::optional<std::uint64_t> agreement = {};
  /// Likewise; commands that name another run are refused, too.
  std::optional<std::uint64_t> run = {};
  /// Of the run. Whoever says that it is the node of another region is a stranger.
  std::uint32_t region_count = 1U << 20;
  /// Neither sends nor takes commands, and publishes no map: in a run with keys a viewer may not.
  bool only_watches = false;
  /// Takes no commands: none are kept for it here.
  bool only_sends = false;
};

/// Used by one thread. The participant must outlive it.
class ControlBus {
 public:
  ControlBus(Participant& participant, const ControlSettings& settings);
  ~ControlBus();

  /// From now on by this participant, which must outlive it; the one before is not used any more. Requests that were
  /// returned are remembered, nodes and maps are heard anew.
  void move_to(Participant& participant);

  /// Only with a region. False when the write failed twice.
  bool publish_status(const Status& status);
  /// All that listen have the last one.
  bool status_is_known();
  /// The latest status of every region of this run seen so far (also this one's). Where several processes are the
  /// node of a region, the one that was here first counts, until it is lost or has ended.
  const std::map<core::RegionId, SeenStatus>& statuses();
  /// Live nodes of other runs, and those that say that they are this process's region.
  std::vector<SeenStatus> strangers();

  /// Those that wait for a region of this run (kNoRegion).
  std::vector<Status> spares();
  /// This process is no more, whatever DDS still believes: who says so has seen it end.
  void hold_for_dead(std::uint64_t process);
  /// Somebody says so: believed once the process shows no life, and at once if it says so itself.
  void hear_of_death(const RunCommand& lost);

  bool publish_map(const WorldMap& map);
  /// Commands for another map than this one are refused from now on.
  void use_map(std::uint64_t map_version);
  /// Every map seen so far, by map_version. With an agreement, those of this run are those that its nodes have
  /// published, as soon as any of them is known.
  const std::map<std::uint64_t, WorldMap>& maps();

  /// Returns the request id. Late joiners get it too, as long as the sender lives. Throws DdsError when the write
  /// failed twice.
  std::uint64_t send(RunCommand command);
  /// Commands of others that were not returned before, in order of arrival; each request id once. What only a node may
  /// say is refused of anybody else.
  std::vector<RunCommand> take_commands();
  /// This node has computed a state: whoever steps the run may send a command for the next one.
  void note_state();
  /// It cannot be meant: counted against who has sent it.
  void refuse(const RunCommand& command, const std::string& why);

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
