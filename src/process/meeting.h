// Decisions of a node that meets the others of its run: whether another run is in the domain, how far all have met, and
// when the run starts. Input are the statuses and maps that nodes publish. Uses no DDS: time is passed in.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "messages/control_messages.h"
#include "process/recovery.h"

namespace aurasim::process {

/// Identity of this node's run. It distinguishes the run from others in the same DDS domain.
struct OwnRun {
  core::RegionId region{};
  std::uint64_t run = 0;  ///< number of the run
  std::uint64_t agreement = 0;
  std::uint64_t map_version = 0;
  core::Step first_step = 0;  ///< state that the run begins with
  int domain = 0;             ///< DDS domain
  std::string scene;
  std::size_t regions = 1;
};

/// Why the node must refuse to run because of a map in the domain: it is of another map, scene or settings, or begins
/// with another state. Empty if there is none. Two runs would mix their worlds' messages.
std::string refusal_of_maps(const std::map<std::uint64_t, messages::WorldMap>& maps, const OwnRun& own);
/// Why the node must refuse to run because the same launch runs already, by mistake. Empty if it does not. Of two that
/// begin together (`has_published`), the one with the lower number stays.
std::string refusal_of_strangers(const std::vector<messages::SeenStatus>& strangers, const OwnRun& own,
                                 bool has_published);

/// Share of the run's nodes that are there, the node of region `self` included; 0 to 1.
double share_of_nodes(const SeenNodes& nodes, core::RegionId self, std::size_t regions);
/// Measure of how far all nodes have met. It only grows with progress. `endpoints_found`: number of the neighbours'
/// endpoints that this node has found.
std::uint64_t progress_of_meeting(const SeenNodes& nodes, std::uint64_t endpoints_found);
/// Message for users: the nodes that do not wait for the start yet, and why.
std::string who_does_not_wait(const SeenNodes& nodes, std::size_t regions);
/// Messages for users about hosts whose clocks are wrong; the run does not depend on them. On one host a clock that
/// looks behind is not named: its statuses were only slow, because many processes start at once.
std::vector<std::string> wrong_clocks(const SeenNodes& nodes, bool is_one_host);
/// The command with the clock difference to its sender, from the fastest of the last statuses. A single message may
/// have been long on its way, which looks like a clock that is behind.
messages::RunCommand with_clock_of(const SeenNodes& nodes, core::RegionId sender, messages::RunCommand command);

/// The start of a generation that this node waits for. The node of region 0 sends it once all regions wait.
class AwaitedStart {
 public:
  AwaitedStart(core::RegionId region, std::size_t regions) : region_(region), regions_(regions) {}

  /// From now on the start of this generation is awaited, as soon as the last one is forgotten.
  void await(core::Generation generation) { generation_ = generation; }
  void forget() { start_.reset(); }
  core::Generation generation() const { return generation_; }
  const std::optional<messages::RunCommand>& start() const { return start_; }

  /// True if this start command is the one that is awaited.
  bool is_awaited(const messages::RunCommand& start) const { return !start_ && start.generation == generation_; }
  void accept(const messages::RunCommand& start) { start_ = start; }
  /// The start command that this node has to send now. `wall_ns`: wall clock, nanoseconds since 1970.
  std::optional<messages::RunCommand> to_send(const SeenNodes& nodes, std::uint64_t run, std::int64_t wall_ns) const;

 private:
  core::RegionId region_;
  std::size_t regions_;
  core::Generation generation_ = 0;
  std::optional<messages::RunCommand> start_;
};

/// Names nodes that die while all wait for each other. A user may start them again; a launcher ends the run.
class EarlyDeaths {
 public:
  /// Messages for users about nodes that have died since the last call. A node that has finished a short run does not
  /// count, even if its message that the run begins is still on its way.
  std::vector<std::string> look(const SeenNodes& nodes);

 private:
  std::set<core::RegionId> named_;
};

}  // namespace aurasim::process
