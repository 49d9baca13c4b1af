// Parts of the world that a node keeps, to go back to when a node has died: its own parts of recent states, those of
// the regions whose keeper it is, and after a recovery the parts of all regions in the state that all went back to.
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
#include "messages/control_messages.h"

namespace aurasim::process {

class Checkpoints {
 public:
  /// `participant` must outlive this object.
  Checkpoints(dds::Participant& participant, core::RegionId region) : region_(region) { move_to(participant); }

  /// Uses another participant from now on. The parts kept stay; keepers have to be named anew.
  void move_to(dds::Participant& participant);

  /// Begins an era: the scene begins from its first state. Parts of earlier eras do not fit it and are dropped.
  void begin_era(core::Generation era);
  /// Names the regions that keep this node's parts from now on (dds::CheckpointBus).
  void use_keepers(std::vector<core::RegionId> keepers, core::Generation life);
  const std::vector<core::RegionId>& keepers() const { return keepers_; }

  /// Adds this node's part of a state. It counts once the records of all states up to `recorded` are on disk, because
  /// records that are not on disk die with the node.
  void add(cut::SavedWorld part, core::Step recorded);
  /// The state up to which records must be on disk for the oldest waiting part. Nothing if no part waits.
  std::optional<core::Step> waits_for() const;
  /// Takes in parts that others have sent, and sends this node's newest part to its keepers. `recorded`: records up to
  /// this state are on disk.
  void progress(core::Step recorded);
  /// The parts that this node keeps, for its status.
  std::vector<messages::KeptPart> parts() const;

  /// The octets of a part. Null if this node does not keep it.
  const std::string* find(core::RegionId region, core::Step step) const;
  /// All nodes go back to state `step` of this era; `parts` are its parts. For the era's first state `parts` may be
  /// empty.
  void go_back(core::Generation era, core::Step step, const std::map<core::RegionId, std::string>& parts);
  /// Sends a part to all nodes, in a recovery.
  bool give(const messages::Checkpoint& checkpoint) { return bus_->send_to_all(checkpoint); }
  /// Parts sent to all nodes for this generation so far, by region.
  const std::map<core::RegionId, std::string>& given(core::Generation generation, messages::Checkpoint::Kind kind);
  /// Octets sent to keepers; left_out() is the number of parts not sent to a keeper because it had not received the
  /// part before.
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
  std::set<core::RegionId> wards_;     ///< regions whose keeper this node is
  std::optional<core::Step> all_had_;  ///< state that all went back to, as long as its parts are kept
  struct Given {
    core::Generation generation = 0;
    std::map<core::RegionId, std::string> parts, orders;
  };
  Given given_;  ///< what was sent for the newest generation that anything was sent for
  std::uint64_t sent_bytes_ = 0, left_out_ = 0;
};

}  // namespace aurasim::process
