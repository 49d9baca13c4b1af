// Decides when a node has to wait or to stop because the rest of the run may go on without it: it has lost the
// majority, or another process has its region. The reason is that two hosts of one body are worse than none. Time is
// passed in.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "node/quorum.h"

namespace aurasim::process {

struct FenceSettings {
  core::RegionId region{};
  std::uint32_t regions = 1;  ///< number of regions of the run
  bool can_be_cut = false;    ///< other nodes may be on other hosts
  bool never_waits = false;   ///< the run is free_running
};

class Fence {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns the signs of all regions but this one. Called only when the fence needs them.
  using Peers = std::function<std::map<core::RegionId, node::PeerSign>()>;

  Fence(const FenceSettings& settings, Peers peers);

  /// True while the node may compute its next state. `dead`: neighbours marked dead. The call is cheap while there are
  /// none. A node that is cut off may wait for ever, because only the majority can give its region to another process.
  bool open(const std::vector<core::RegionId>& dead, Clock::time_point now);
  /// True if this node receives from too few of the others to know what they do.
  bool is_cut_off() const { return standing_ == node::Standing::kCutOff; }
  /// True once the node has to stop for good.
  bool closed() const { return !reason_.empty(); }
  /// Closes the fence for good. `reason`: message for users.
  void close(std::string reason) { reason_ = std::move(reason); }
  /// To be called when the node waits because another has died. Earlier judgements do not count any more, and every
  /// call of open() judges anew. From then on the statuses alone decide which nodes are lost.
  void watch_closely() { watches_closely_ = true; }
  /// To be called when all regions have nodes again.
  void begin_anew();
  /// Why the fence is closed, as a message for users.
  const std::string& reason() const { return reason_; }

 private:
  void look(const std::vector<core::RegionId>& dead, Clock::time_point now);

  FenceSettings settings_;
  Peers peers_;
  node::Quorum quorum_;
  node::Standing standing_ = node::Standing::kGoOn;
  bool watches_closely_ = false;
  std::size_t dead_ = 0;  ///< number of dead neighbours at the last look
  Clock::time_point next_look_;
  std::string reason_;
};

}  // namespace aurasim::process
