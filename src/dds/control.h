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

#include "dds/participant.h"
#include "messages/control_messages.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

struct ControlSettings {
  /// Map version that received commands must name; others are refused and counted. Maps of all runs are received.
  /// Nothing: all commands are accepted.
  std::optional<std::uint64_t> map_version = {};
  /// Region whose node this process is; it may publish_status. Nothing: the process is a launcher or tool.
  std::optional<core::RegionId> region = {};
  /// Agreement hash of this run. A node whose status names another one is a stranger. Nothing: nodes of all runs count.
  std::optional<std::uint64_t> agreement = {};
  /// Number of this run. A node whose status names another one is a stranger, and commands that name another run are
  /// refused. Nothing: nodes of all runs count.
  std::optional<std::uint64_t> run = {};
  /// Number of regions in the run. A node that claims a region beyond them is a stranger.
  std::uint32_t region_count = 1U << 20;
  /// The process neither sends nor receives commands, and publishes no map: in a run with keys a viewer has no right
  /// to.
  bool only_watches = false;
  /// The process receives no commands, so DDS keeps none for it.
  bool only_sends = false;
};

/// Used by one thread. The participant must outlive it.
class ControlBus {
 public:
  ControlBus(Participant& participant, const ControlSettings& settings);
  ~ControlBus();

  /// From now on uses this participant, which must outlive the bus; the former one is not used any more. Requests
  /// already returned stay remembered. Nodes and maps are discovered anew.
  void move_to(Participant& participant);

  /// Precondition: the settings name a region. Returns false when the write failed twice.
  bool publish_status(const messages::Status& status);
  /// True when every matched reader has acknowledged the last status.
  bool status_is_known();
  /// Returns the latest status of every region of this run seen so far, the own one included. Where several processes
  /// claim to be the node of one region, the first one counts until it is lost or has ended.
  const std::map<core::RegionId, messages::SeenStatus>& statuses();
  /// Returns live nodes of other runs, and live nodes that claim to be this process's region.
  std::vector<messages::SeenStatus> strangers();

  /// Returns the spares of this run: processes that wait for a region (kNoRegion).
  std::vector<messages::Status> spares();
  /// Marks `process` dead, whatever DDS still reports. For a caller that has seen the process end.
  void hold_for_dead(std::uint64_t process);
  /// Handles the report `lost` of a death. It is believed at once if the process itself has sent it, and otherwise once
  /// the process shows no life. A report about a process that lives is refused.
  void receive_death(const messages::RunCommand& lost);

  bool publish_map(const messages::WorldMap& map);
  /// Commands for another map than this one are refused from now on.
  void use_map(std::uint64_t map_version);
  /// Returns every map seen so far, by map_version. With an agreement only maps that nodes of this run have published,
  /// as soon as any node is known.
  const std::map<std::uint64_t, messages::WorldMap>& maps();

  /// Sends a command. Late joiners receive it too, as long as the sender lives. Returns the request id. Throws DdsError
  /// when the write failed twice.
  std::uint64_t send(messages::RunCommand command);
  /// Returns commands of other processes that were not returned before, in order of arrival, each request id once. A
  /// command that only a node may send is refused from any other process.
  std::vector<messages::RunCommand> take_commands();
  /// Handles the reports of deaths among these commands at once. For a caller that cannot execute the others now; they
  /// stay for take_commands().
  void hear_of_deaths();
  /// To be called when this node has computed a state: it allows one more command to each process that steps the run.
  void note_state();
  /// Refuses a command that was taken but makes no sense, and counts it against its sender. `why` is for the log.
  void refuse(const messages::RunCommand& command, const std::string& why);

  /// Returns when something arrived or a node's proof of life changed, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

  /// Number of other processes that receive run_control. A command sent to nobody still reaches late joiners.
  std::size_t listeners() const;

  const messages::WireErrors& refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
