// Keeps track of the processes that claim to be nodes: which of them belong to this run, and which one is each region's
// node.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dds/endpoints.h"
#include "dds/hub_silence.h"
#include "dds/speakers.h"
#include "dds/watch.h"
#include "messages/control_messages.h"

namespace aurasim::dds {

struct RosterSettings {
  std::uint32_t region_count = 0;
  std::optional<std::uint64_t> agreement, run;  ///< a node with another one is a stranger
  std::optional<core::RegionId> region;         ///< region of the own node; nothing: this process is no node
  Guid writer;                                  ///< the own writer of statuses; only with a region
  bool stays_on_this_host = false;              ///< all processes of the run are on this host, so they can be looked up
  bool believes_silence = true;  ///< if false, a silent process is lost only when there is no such process any more
  /// A process of this host whose statuses come by a hub, and that has been alive, counts as lost so long after its
  /// end. Its last word, that it has finished, may come from the hub that late on a busy host.
  std::chrono::nanoseconds until_last_word = std::chrono::seconds(2);
  /// On several hosts: how long no status has come by a hub before a node is lost (hub_silence.h).
  std::chrono::nanoseconds silence_by_hub{0};
  std::function<std::chrono::steady_clock::time_point()> now = std::chrono::steady_clock::now;
};

/// Used by one thread. `speakers` must outlive it.
class NodeRoster {
 public:
  NodeRoster(RosterSettings settings, Speakers& speakers) : settings_(std::move(settings)), speakers_(speakers) {}

  /// Returns why `status` cannot be a node's status of itself. Empty: it can.
  std::string problem_with(const messages::Status& status, const Origin& origin) const;
  void note(messages::Status status, const Origin& origin);
  /// Updates which proofs of life have ended, and which status counts for each region.
  void look(const std::vector<RemoteWriter>& writers);
  /// True if a status or the report of a death has come since the last look.
  bool has_news() const { return has_death_ || !fresh_.empty(); }
  /// Like look(), but only at regions of which statuses have come, if no death was reported.
  void look_at_news(const std::vector<RemoteWriter>& writers);

  /// Statuses of this run's nodes, as of the last look().
  const std::map<core::RegionId, messages::SeenStatus>& statuses() const { return statuses_; }
  /// Live nodes of other runs, and live nodes that claim to be this process's region, as of the last look().
  std::vector<messages::SeenStatus> strangers() const;
  /// Spares: processes that wait for a region of this run, as of the last look().
  std::vector<messages::Status> spares() const;

  void hold_for_dead(std::uint64_t process) {
    dead_.insert(process);
    has_death_ = true;
  }
  /// Handles a report that `process` has died, which is believed once it shows no life. Returns false when it shows
  /// some.
  bool receive_death(std::uint64_t process);

  /// True when a sample of this origin was sent by `process` itself.
  bool is_of(std::uint64_t process, const Origin& origin) const;
  /// True when the sender is a node of `region` or about to be one. Of two such senders one may have died without that
  /// being known yet.
  bool is_of(core::RegionId region, const Origin& origin) const;

 private:
  struct Received {  ///< the last status of one process
    Guid writer;
    bool by_hub = false;  ///< then DDS here says nothing of the writer
    messages::SeenStatus seen;
    std::chrono::steady_clock::time_point alive{};     ///< the last look that showed life; by_hub only
    std::deque<std::chrono::nanoseconds> clock_ahead;  ///< estimates from the last samples
  };

  bool is_region(core::RegionId region) const;
  bool has_room_for(core::RegionId region) const;
  bool is_lost(const Received& one, const RemoteWriter* writer) const;
  bool shows_no_life(const Received& one) const;
  void look_at(core::RegionId region, std::vector<Received>& of_region, const std::vector<RemoteWriter>& writers);
  void choose_publisher(core::RegionId region, const std::vector<Received>& of_region);
  bool is_of_the_run(const messages::Status& status, const Guid& writer) const;
  bool is_of_the_run(const Received& one) const { return is_of_the_run(one.seen.status, one.writer); }

  RosterSettings settings_;
  Speakers& speakers_;
  HubSilence hub_silence_;
  bool has_death_ = false;          ///< one was reported since the last look
  std::set<core::RegionId> fresh_;  ///< regions of which statuses have come since the last look
  std::map<core::RegionId, std::vector<Received>> received_;  ///< processes in the order of their first samples
  std::map<core::RegionId, Guid> publishers_;
  std::map<core::RegionId, messages::SeenStatus> statuses_;
  std::set<std::uint64_t> dead_;     ///< processes that are known to have ended
  std::set<std::uint64_t> claimed_;  ///< processes that others report as dead
};

}  // namespace aurasim::dds
