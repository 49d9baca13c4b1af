// What a node decides while it stands because others have died or fell silent: which regions nobody is there for, who
// takes them over, and when a person has to be asked. No DDS: from what the nodes say of themselves. Time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/control_messages.h"

namespace aurasim::cli {

using SeenNodes = std::map<core::RegionId, dds::SeenStatus>;

/// A node that is heard: its proof of life has not ended, and it has not said that it ends. It may be cut off.
bool is_heard(const dds::SeenStatus& seen);

/// Regions of a run of `regions` that a node of region `self` does not hear.
std::vector<core::RegionId> unheard_regions(const SeenNodes& nodes, core::RegionId self, std::uint32_t regions);

/// The newest state of which a heard node keeps every region's part. Parts of another era do not count.
std::optional<core::Step> newest_complete(const SeenNodes& nodes, core::Generation era, std::uint32_t regions);

/// What a node knows of its own world when it looks for a reason to stand.
struct OwnWorld {
  core::RegionId region{};
  core::Generation current = 0;              ///< that it computes, or is about to begin
  std::vector<core::RegionId> silent;        ///< neighbours whose streams have ended, or said what cannot be
  const dds::RunCommand* restore = nullptr;  ///< the newest that it has heard; null: none
  bool is_going_back = false;                ///< all have agreed on `restore`, and not all have begun
};

/// Why this node must not compute its next state: another node of its generation has died, has left, or stands itself.
std::optional<std::string> why_stand(const SeenNodes& nodes, const OwnWorld& own);

/// What a restore that is heard means to process `process` of a region.
enum class RestoreMeaning : std::uint8_t {
  kNothing,  ///< it is older than what is known
  kGoBack,   ///< this process goes back with the others
  kLeftOut,  ///< another process has the region, if the others begin this generation: older than what is known
  kReplaced  ///< another process has the region: this one's world is not the run's any more
};
/// `begun`: the generation that the process computes in. `known`: the newest that it computes in, is about to begin, or
/// has heard a restore of. Two nodes that do not hear the same may send restores of one generation: the process that
/// one of them leaves out gives way, so that the other one does not wait for it in vain.
RestoreMeaning meaning_of(const dds::RunCommand& restore, core::RegionId region, std::uint64_t process,
                          core::Generation begun, core::Generation known);

struct RecoverySettings {
  core::RegionId region{};
  std::uint32_t regions = 1;                       ///< of the run
  std::chrono::steady_clock::duration patience{};  ///< with a vacant region, before a host computes two
  bool can_be_cut = false;                         ///< the others may be on other hosts
  bool has_launcher = false;                       ///< it starts processes again by itself, and is faster than spares
  core::Step checkpoint_steps = 1;
};

/// What a node sees while it stands.
struct RecoveryView {
  const SeenNodes& nodes;                  ///< this node's own status included
  const std::set<std::uint64_t>& leaving;  ///< processes that have said that they leave
  std::uint64_t process = 0;               ///< this one
  bool knows_world = true;                 ///< false: it has come to take a region over
  bool may_go_on = true;                   ///< it hears the majority (Fence)
  bool is_cut_off = false;                 ///< it knows that it does not
  core::Step step = 0;                     ///< in which it stands
};

/// What a node that stands does now.
struct RecoveryActs {
  std::vector<core::RegionId> vacant;       ///< regions that nobody is there for
  std::vector<core::RegionId> call_spares;  ///< regions that a spare is to be called for, if there is one
  std::vector<core::RegionId> stand_ins;    ///< regions that this host starts a second process for
  bool meets_anew = false;                  ///< this process leaves DDS and joins it again, with the world that it has
  std::optional<core::Step> replaced_in;    ///< the others go on from this state with another process in its place
  bool gives_up = false;                    ///< nobody has come for a vacant region, however often that was tried
};

class Recovery {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Recovery(const RecoverySettings& settings) : settings_(settings) {}

  /// The node stands from now on.
  void begin(Clock::time_point now);
  RecoveryActs look(const RecoveryView& view, Clock::time_point now);
  /// A spare was called for this region: no other one for the next seconds.
  void note_called(core::RegionId region, Clock::time_point now) { called_[region] = now; }

  /// A restore that names another process for this region: it counts once the others compute in its generation.
  void note_left_out(const dds::RunCommand& restore) { left_out_[restore.generation] = restore.at_step; }

  /// Remembers the newest state that was kept whole. Called while the world runs, and when the node stands.
  void note_kept(const SeenNodes& nodes, core::Generation era);
  /// False once a state of this era after the first one was kept whole: then nobody begins again from the first one
  /// without being told to.
  bool may_begin_again(core::Generation era) const { return !kept_ || kept_era_ != era; }
  /// The newest one.
  std::optional<core::Step> kept() const { return kept_; }

  /// Of a process that has come to take a region over. `now` never goes back.
  bool nobody_knows_the_world(const SeenNodes& nodes, Clock::time_point now);
  /// The run is over, or the others have computed without this process for long.
  bool is_not_needed(const SeenNodes& nodes, Clock::time_point now);

  /// Does this process act for `region`, as the next one that stays?
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
  Clock::time_point met_;                                      ///< when this process left DDS and joined it again
  std::map<core::RegionId, Clock::time_point> cut_off_since_;  ///< heard, and says so
  std::map<core::RegionId, Clock::time_point> called_;         ///< regions that spares were called for
  std::map<core::RegionId, StandIn> stood_in_;                 ///< in a row
  std::optional<core::Step> kept_;
  core::Generation kept_era_ = 0;
};

}  // namespace aurasim::cli
