// Topic checkpoint: parts of the world in one state, to go back to when a node has died. A region sends its part to its
// keepers, which are other regions. In a recovery, a node that keeps a part sends it to all nodes.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/ids.h"
#include "dds/participant.h"
#include "messages/checkpoint.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class CheckpointBus {
 public:
  /// `region`: the region of the own node.
  CheckpointBus(Participant& participant, core::RegionId region);
  ~CheckpointBus();

  /// From now on the regions `keepers` keep this node's parts. `life`: generation with which the run went on after the
  /// last death. A process that the others have marked dead has another one, so it neither receives nor sends parts
  /// even if it still runs.
  void use_keepers(const std::vector<core::RegionId>& keepers, core::Generation life);
  /// Sends a part to keep (kToKeep) to each keeper that has acknowledged all parts before it. A keeper behind a slow
  /// link misses some parts and does not hold up the others. Returns the number of keepers that it was sent to.
  std::size_t send_to_keepers(const messages::Checkpoint& checkpoint);
  /// Sends a part to all nodes, in a recovery. The last one of each source and kind is kept for nodes that join later.
  /// Returns false when the write failed twice.
  bool send_to_all(const messages::Checkpoint& checkpoint);
  /// Returns the parts that arrived since the last call, sent to this node or to all.
  std::vector<messages::Checkpoint> take();

  const messages::WireErrors& refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
