// When a node has to stop because the rest of the run may go on without it: the others hold it for dead, it was held up
// for so long that they may, or it has lost touch with the majority. Two hosts of one body are worse than none.
#pragma once

#include <chrono>
#include <string>

#include "config/launch.h"
#include "core/protocol.h"
#include "dds/control.h"
#include "dds/participant.h"
#include "node/quorum.h"

namespace aurasim::cli {

class Fence {
 public:
  /// Both outlive it.
  Fence(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control, core::RegionId region);

  /// True while the node may compute its next state. Cheap while no region is lost.
  bool open(const core::Protocol& protocol);
  /// For good: the node has to stop.
  bool closed() const { return !reason_.empty(); }
  /// Why it is closed, for people.
  const std::string& reason() const { return reason_; }

 private:
  std::string why_stop(const core::Protocol& protocol);
  void look(const core::Protocol& protocol);

  core::RegionId region_;
  bool alone_;        ///< no other regions
  bool can_be_cut_;   ///< the others may be on other hosts
  bool never_waits_;  ///< free_running
  dds::Participant& participant_;
  dds::ControlBus& control_;
  node::Quorum quorum_;
  node::Standing standing_ = node::Standing::kGoOn;
  std::size_t dead_ = 0;  ///< neighbours when last looked
  std::chrono::steady_clock::time_point next_look_;
  std::string reason_;
};

}  // namespace aurasim::cli
