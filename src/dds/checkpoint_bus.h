// Topic checkpoint: parts of the world in one state, to go back to when a node has died. A region gives its own to
// another one, which keeps them; in a recovery, whoever has a part gives it to all.
#pragma once

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

  /// From now on `keeper` is who keeps our parts. `life`: with which generation the run went on after the last death; a
  /// process that the others have given up, and that may still be there, gets and gives nothing.
  void use_keeper(core::RegionId keeper, core::Generation life);
  /// To the keeper, if there is one, or to all, by its kind. Of a source and kind the last one counts, for those, too,
  /// who come later. False when the write failed twice.
  bool send(const Checkpoint& checkpoint);
  /// The keeper has got all that was sent to it.
  bool is_kept();
  /// What others have sent to us or to all since the last call.
  std::vector<Checkpoint> take();

  const WireErrors& refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
