// Decisions of a node about processes that leave the run and give their regions to others: which processes leave, and
// when this node may. Input are the statuses that nodes publish. Uses no DDS: time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "messages/control_messages.h"
#include "process/recovery.h"

namespace aurasim::process {

/// True if a spare that was called, or a process that a launcher has started, is there for the region of `own`.
bool has_successor(const std::vector<messages::SeenStatus>& strangers, const messages::Status& own);

/// The parts that this node keeps and the keepers of its own parts, for the decision whether it may leave.
struct KeptView {
  core::Step step = 0;                           ///< the node's present state
  bool is_paused = false;                        ///< a paused run has no newer state
  const std::vector<messages::KeptPart>& parts;  ///< parts that this node keeps
  const std::vector<core::RegionId>& keepers;    ///< regions that keep this node's parts
};

class Leaving {
 public:
  using Clock = std::chrono::steady_clock;

  /// `process`: number of this process.
  Leaving(core::RegionId region, std::uint64_t process) : region_(region), process_(process) {}

  /// This process was asked to leave: its host goes down, but the run goes on. It leaves after some seconds even if no
  /// successor comes.
  void begin(Clock::time_point now);
  bool has_begun() const { return leaves_by_.has_value(); }
  /// True if no successor has come in time.
  bool is_overdue(Clock::time_point now) const { return leaves_by_ && now > *leaves_by_; }

  /// Receives a drain command. True if it is news and names a process of this run.
  bool note_drain(const messages::RunCommand& drain, const SeenNodes& nodes);
  /// True if this node gives its region to another process as soon as there is one.
  bool drains() const { return drains_; }
  /// Processes that leave.
  const std::set<std::uint64_t>& processes() const { return processes_; }
  /// True if another node stays that can go on with this node's world.
  bool can_leave_to_others(const SeenNodes& nodes) const;
  /// True if this node's successor is there, and a state since then is kept by all keepers, so that the run does not go
  /// back far. `has_successor`: see above.
  bool may_leave(bool has_successor, const KeptView& kept, const SeenNodes& nodes);

 private:
  core::RegionId region_;
  std::uint64_t process_;
  bool drains_ = false;
  std::optional<Clock::time_point> leaves_by_;
  std::set<std::uint64_t> processes_;
  std::optional<core::Step> successor_since_;  ///< state in which the successor was first seen
};

}  // namespace aurasim::process
