// Which processes say that they are nodes, which of them are of this run, and which one is each region's node.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/control_messages.h"
#include "dds/endpoints.h"
#include "dds/speakers.h"
#include "dds/watch.h"

namespace aurasim::dds {

struct RosterSettings {
  std::uint32_t region_count = 0;
  std::optional<std::uint64_t> agreement, run;  ///< whoever has another one is a stranger
  std::optional<core::RegionId> region;         ///< whose node this process is
  Guid writer;                                  ///< of its statuses; only with a region
  bool stays_on_this_host = false;              ///< all processes can be looked for
  bool believes_silence = true;                 ///< else who is silent is lost only if there is no such process
};

/// Used by one thread. `speakers` must outlive it.
class NodeRoster {
 public:
  NodeRoster(RosterSettings settings, Speakers& speakers) : settings_(settings), speakers_(speakers) {}

  /// Why this cannot be what a node says of itself. Empty: it can.
  std::string problem_with(const Status& status, const Origin& origin) const;
  void note(Status status, const Origin& origin);
  /// Whose proof of life has ended, and whose status stands for each region now.
  void look(const std::vector<RemoteWriter>& writers);

  /// As of the last look.
  const std::map<core::RegionId, SeenStatus>& statuses() const { return statuses_; }
  /// Likewise: live nodes of other runs, and those that say that they are this process's region.
  std::vector<SeenStatus> strangers() const;
  /// Likewise: those that wait for a region of this run.
  std::vector<Status> spares() const;

  void hold_for_dead(std::uint64_t process) { dead_.insert(process); }
  /// Somebody says so: believed once the process shows no life. False: it shows some.
  bool hear_of_death(std::uint64_t process);

  /// Does this process itself speak?
  bool is_of(std::uint64_t process, const Origin& origin) const;
  /// Is it a node of that region, or about to be one? Of two, one may not yet be known to have died.
  bool is_of(core::RegionId region, const Origin& origin) const;

 private:
  struct Received {  ///< what one process has published last
    Guid writer;
    SeenStatus seen;
    std::deque<std::chrono::nanoseconds> clock_ahead;  ///< by the last samples
  };

  bool is_region(core::RegionId region) const;
  bool has_room_for(core::RegionId region) const;
  bool is_lost(const Received& one, const RemoteWriter* writer) const;
  bool shows_no_life(const Received& one) const;
  void choose_publisher(core::RegionId region, const std::vector<Received>& of_region);
  bool is_of_the_run(const Status& status, const Guid& writer) const;
  bool is_of_the_run(const Received& one) const { return is_of_the_run(one.seen.status, one.writer); }

  RosterSettings settings_;
  Speakers& speakers_;
  std::map<core::RegionId, std::vector<Received>> received_;  ///< in order of the first sample
  std::map<core::RegionId, Guid> publishers_;
  std::map<core::RegionId, SeenStatus> statuses_;
  std::set<std::uint64_t> dead_;     ///< processes that have ended
  std::set<std::uint64_t> claimed_;  ///< others say so
};

}  // namespace aurasim::dds
