// What a node keeps of the world, to go back to when a node has died: its own parts in recent states, those of the
// regions whose keeper it is, and after a recovery everybody's in the state that all went back to.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/ids.h"
#include "cut/cut_file.h"
#include "dds/checkpoint_bus.h"
#include "dds/control_messages.h"

namespace aurasim::cli {

class Checkpoints {
 public:
  /// The participant outlives it.
  Checkpoints(dds::Participant& participant, core::RegionId region) : region_(region) { move_to(participant); }

  /// From now on by this participant. What is kept stays; keepers are to be named anew.
  void move_to(dds::Participant& participant);

  /// The scene is begun from its first state: what was kept before does not fit.
  void begin_era(core::Generation era);
  /// These regions keep our parts from now on (dds::CheckpointBus).
  void use_keepers(std::vector<core::RegionId> keepers, core::Generation life);
  const std::vector<core::RegionId>& keepers() const { return keepers_; }

  /// Our part in a state. It counts once all states up to `recorded` are on disk: what is recorded of it, too, is gone
  /// with the node otherwise.
  void add(cut::SavedWorld part, core::Step recorded);
  /// Up to which state must be on disk for the oldest part that waits for that; nothing: none does.
  std::optional<core::Step> waits_for() const;
  /// Takes in what others send; gives our newest part to the keepers. `recorded`: states up to it are on disk.
  void progress(core::Step recorded);
  /// For the status.
  std::vector<dds::KeptPart> parts() const;

  /// The octets of a part. Null: it is not here.
  const std::string* find(core::RegionId region, core::Step step) const;
  /// All go back to state `step` of this era, of which these are the parts. Of its first state there need not be any.
  void go_back(core::Generation era, core::Step step, const std::map<core::RegionId, std::string>& parts);
  /// In a recovery: to all.
  bool give(const dds::Checkpoint& checkpoint) { return bus_->send_to_all(checkpoint); }
  /// What was given to all for this generation, so far: by region.
  const std::map<core::RegionId, std::string>& given(core::Generation generation, dds::Checkpoint::Kind kind);
  /// Octets sent to keepers, and parts that a keeper was not sent since it had not got the one before.
  std::uint64_t sent_bytes() const { return sent_bytes_; }
  std::uint64_t left_out() const { return left_out_; }

 private:
  struct Coming {
    core::Step step = 0;
    core::Step recorded = 0;
    std::future<std::string> octets;
  };
  void take();
  void keep(core::RegionId region, core::Step step, std::string octets);
  void send_to_keepers(core::Step step);
  void forget_what_all_had();

  core::RegionId region_;
  std::optional<dds::CheckpointBus> bus_;
  std::vector<core::RegionId> keepers_;
  core::Generation era_ = 0;
  std::deque<Coming> coming_;
  std::map<core::RegionId, std::map<core::Step, std::string>> kept_;
  std::set<core::RegionId> wards_;     ///< regions that give us their parts
  std::optional<core::Step> all_had_;  ///< state that all went back to, while its parts are still here
  struct Given {
    core::Generation generation = 0;
    std::map<core::RegionId, std::string> parts, orders;
  };
  Given given_;  ///< for the newest generation that somebody has given something for
  std::uint64_t sent_bytes_ = 0, left_out_ = 0;
};

}  // namespace aurasim::cli
