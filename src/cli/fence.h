// When a node has to stand or to stop because the rest of the run may go on without it: it has lost touch with the
// majority, or another process has its region. Two hosts of one body are worse than none. Time is passed in.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "node/quorum.h"

namespace aurasim::cli {

struct FenceSettings {
  core::RegionId region{};
  std::uint32_t regions = 1;  ///< of the run
  bool can_be_cut = false;    ///< the others may be on other hosts
  bool never_waits = false;   ///< free_running
};

class Fence {
 public:
  using Clock = std::chrono::steady_clock;

  /// All regions but this one. Asked only when there is something to find out.
  using Peers = std::function<std::map<core::RegionId, node::PeerSign>()>;

  Fence(const FenceSettings& settings, Peers peers);

  /// True while the node may compute its next state. `dead`: neighbours that it holds for dead. Cheap while there are
  /// none. A node that is cut off may wait for the others for ever: nobody takes its region over but with the majority.
  bool open(const std::vector<core::RegionId>& dead, Clock::time_point now);
  /// Hears too few of the others to know what they do.
  bool is_cut_off() const { return standing_ == node::Standing::kCutOff; }
  /// For good: the node has to stop.
  bool closed() const { return !reason_.empty(); }
  /// `reason`: for people.
  void close(std::string reason) { reason_ = std::move(reason); }
  /// The node stands, because somebody has died: what was judged before that does not count any more, and every call
  /// judges anew. From then on the statuses alone say who is lost.
  void watch_closely() { watches_closely_ = true; }
  /// All regions have nodes again.
  void begin_anew();
  /// Why it is closed, for people.
  const std::string& reason() const { return reason_; }

 private:
  void look(const std::vector<core::RegionId>& dead, Clock::time_point now);

  FenceSettings settings_;
  Peers peers_;
  node::Quorum quorum_;
  node::Standing standing_ = node::Standing::kGoOn;
  bool watches_closely_ = false;
  std::size_t dead_ = 0;  ///< neighbours when last looked
  Clock::time_point next_look_;
  std::string reason_;
};

}  // namespace aurasim::cli
