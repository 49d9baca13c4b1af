// Topic checkpoint: parts of the world in one state, to go back to when a node has died. A region gives its own to
// its keepers, other regions that keep them; in a recovery, a node that has a part gives it to all.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/ids.h"
#include "dds/checkpoint.h"
#include "dds/participant.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class CheckpointBus {
 public:
  /// Of `region`'s node.
  CheckpointBus(Participant& participant, core::RegionId region);
  ~CheckpointBus();

  /// From now on these regions keep our parts. `life`: with which generation the run went on after the last death; a
  /// process that the others have given up, and that may still be there, gets and gives nothing.
  void use_keepers(const std::vector<core::RegionId>& keepers, core::Generation life);
  /// A part to keep (kToKeep), to each keeper that has acknowledged all parts before it. Returns to how many it was
  /// sent: a keeper behind a slow link misses some, and does not hold the others up.
  std::size_t send_to_keepers(const Checkpoint& checkpoint);
  /// To all nodes, in a recovery. Of a source and kind the last one counts, for those, too, who come later. False when
  /// the write failed twice.
  bool send_to_all(const Checkpoint& checkpoint);
  /// What others have sent to us or to all since the last call.
  std::vector<Checkpoint> take();

  const WireErrors& refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
