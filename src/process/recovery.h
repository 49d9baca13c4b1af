// Decisions of a node that waits because others have died or fell silent: which regions have no node, which process
// takes each over, and when a user has to be asked. Input are the statuses that nodes publish; this file uses no DDS.
// Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "messages/control_messages.h"

namespace aurasim::process {

using SeenNodes = std::map<core::RegionId, messages::SeenStatus>;

/// True if the node's liveliness has not ended and it has not published that it ends. It may be cut off all the same.
bool is_reachable(const messages::SeenStatus& seen);

/// Regions 0 to `regions` - 1 whose nodes the node of region `self` does not receive from.
std::vector<core::RegionId> unreachable_regions(const SeenNodes& nodes, core::RegionId self, std::uint32_t regions);

/// The newest state of which every region's part is kept by some reachable node (is_reachable). Parts of another era do
/// not count.
std::optional<core::Step> newest_complete(const SeenNodes& nodes, core::Generation era, std::uint32_t regions);

/// Message for users: what a node waits for in a recovery. `vacant`: regions without a node. `unreachable`: regions
/// that the node does not receive from. `question`: decision that a user has to take; empty: none.
std::string what_recovery_waits_for(bool is_cut_off, const std::string& question,
                                    const std::vector<core::RegionId>& vacant,
                                    const std::vector<core::RegionId>& unreachable);
/// Why the run ends when no process takes over these regions, whose nodes have died.
std::string nobody_takes_over(const std::vector<core::RegionId>& vacant);

/// A node's knowledge of its own world, for the decision whether it has to wait.
struct OwnWorld {
  core::RegionId region{};
  core::Generation current = 0;        ///< generation that it computes, or is about to begin
  std::vector<core::RegionId> silent;  ///< neighbours whose streams have ended, or have sent impossible messages
  const messages::RunCommand* restore = nullptr;  ///< the newest restore command that it has received; null: none
  bool is_going_back = false;                     ///< all have agreed on `restore`, and not all have begun
  /// The present state, where regions are coupled and the run goes on: the next one cannot be computed without all.
  std::optional<core::Step> coupled_in = {};
};

/// Reason why this node must not compute its next state: another node of its generation has died, has left, or waits
/// itself. Nothing if this node may compute.
std::optional<std::string> why_stand(const SeenNodes& nodes, const OwnWorld& own);

/// Meaning of a restore command to the process that receives it.
enum class RestoreMeaning : std::uint8_t {
  kNothing,  ///< the restore is older than what the process knows
  kGoBack,   ///< this process goes back with the other nodes
  kLeftOut,  ///< the restore is older than what is known, and gives the region to another process if the others begin
             ///< its generation
  kReplaced  ///< another process has the region; this one's world is not the run's any more
};
/// Meaning of `restore` for process `process` of `region`. `begun`: the generation that the process computes in.
/// `known`: the newest generation that it computes in, is about to begin, or has received a restore of. Two nodes that
/// receive from different nodes may send restores of the same generation. The process that one of them leaves out then
/// gives way, so that the other one does not wait for it in vain.
RestoreMeaning meaning_of(const messages::RunCommand& restore, core::RegionId region, std::uint64_t process,
                          core::Generation begun, core::Generation known);

struct RecoverySettings {
  core::RegionId region{};
  std::uint32_t regions = 1;                       ///< number of regions of the run
  std::chrono::steady_clock::duration patience{};  ///< how long a region may be vacant before a stand-in is started
  bool can_be_cut = false;                         ///< the others may be on other hosts
  bool has_launcher = false;  ///< a launcher starts processes again by itself, and is faster than spares
  core::Step checkpoint_steps = 1;
};

/// A waiting node's view of the run.
struct RecoveryView {
  const SeenNodes& nodes;                  ///< this node's own status included
  const std::set<std::uint64_t>& leaving;  ///< processes that have published that they leave
  std::uint64_t process = 0;               ///< number of this process
  bool knows_world = true;                 ///< false: this process has come to take a region over
  bool may_go_on = true;                   ///< this node receives from the majority (Fence)
  bool is_cut_off = false;                 ///< this node knows that it is not with the majority
  core::Step step = 0;                     ///< state in which this node waits
};

/// Acts that a waiting node has to execute now.
struct RecoveryActs {
  std::vector<core::RegionId> vacant;       ///< regions without a node
  std::vector<core::RegionId> call_spares;  ///< regions for which a spare is to be called, if there is one
  std::vector<core::RegionId> stand_ins;    ///< regions for which this host starts a second process
  bool meets_anew = false;                  ///< this process leaves DDS and joins it again, with the world that it has
  std::optional<core::Step> replaced_in;    ///< another process has this region; the others go on from here
  bool gives_up = false;                    ///< no process has come for a vacant region, after all attempts
};

class Recovery {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Recovery(const RecoverySettings& settings) : settings_(settings) {}

  /// The node waits from now on.
  void begin(Clock::time_point now);
  RecoveryActs look(const RecoveryView& view, Clock::time_point now);
  /// Chooses a spare for this region and notes the call: no other one is called in the next seconds. Returns the number
  /// of its process. Nothing if each of `spares` was called before.
  std::optional<std::uint64_t> call_spare(const std::vector<messages::Status>& spares, core::RegionId region,
                                          Clock::time_point now);

  /// Notes a restore that names another process for this region. It counts once the others compute in its generation.
  void note_left_out(const messages::RunCommand& restore) { left_out_[restore.generation] = restore.at_step; }

  /// Remembers the newest state that was kept whole. To be called while the world runs, and while the node waits.
  void note_kept(const SeenNodes& nodes, core::Generation era);
  /// False once a later state of this era than its first was kept whole. Then no node begins again from the first state
  /// without a command.
  bool may_begin_again(core::Generation era) const { return !kept_ || kept_era_ != era; }
  /// The newest state that was kept whole.
  std::optional<core::Step> kept() const { return kept_; }

  /// For a process that has come to take a region over: true if no process knows the world. `now` never goes back.
  bool nobody_knows_the_world(const SeenNodes& nodes, Clock::time_point now);
  /// True if the run is over, or the others have computed without this process for long.
  bool is_not_needed(const SeenNodes& nodes, Clock::time_point now);

  /// True if this process is the next one after `region` that stays, and so acts for it.
  bool is_next_after(core::RegionId region, const RecoveryView& view) const;

 private:
  bool is_vacant(core::RegionId region, const SeenNodes& nodes, Clock::time_point now);
  bool calls_spares(const SeenNodes& nodes, Clock::time_point now) const;
  bool tried_too_often(core::RegionId region, core::Step step);
  bool meets_anew(const RecoveryView& view, Clock::time_point now);

  struct StandIn {
    int times = 0;
    core::Step at = 0;
  };
  RecoverySettings settings_;
  Clock::time_point began_, somebody_came_, alone_since_, idle_since_;
  std::map<core::Generation, core::Step> left_out_;
  std::optional<Clock::time_point> unmet_since_;
  Clock::time_point met_;                                      ///< when this process last left DDS and joined it again
  std::map<core::RegionId, Clock::time_point> cut_off_since_;  ///< reachable nodes that publish kCutOff
  std::map<core::RegionId, Clock::time_point> called_;         ///< regions that spares were called for
  std::set<std::uint64_t> called_spares_;                      ///< their processes
  std::map<core::RegionId, StandIn> stood_in_;                 ///< how often in a row this host stood in for a region
  std::optional<core::Step> kept_;
  core::Generation kept_era_ = 0;
};

}  // namespace aurasim::process
